"""Scores: one more exam outweighs any effort."""

from hypothesis import given
from hypothesis import strategies as st

from kurt2rt.experiments.search.score import RobotScore, highest_score, robot_score, score_of
from kurt2rt.experiments.search.settings import Objective
from kurt2rt.experiments.study.jobs import ExaminedOutcome
from tests.examples import examples
from tests.experiments.rows import MADE_OF, judged, lesson

PRESSES: Objective = "passed_then_presses"
COLLISIONS: Objective = "passed_then_presses_and_collisions"
RLAS: Objective = "passed_then_rlas"


def robot(passed: int, presses: int = 10, exams: int = 3, rlas: int = 50, collisions: int = 0) -> RobotScore:
    return RobotScore(passed, exams, presses, collisions, rlas)


def test_exam_without_a_verdict_counts_as_not_passed() -> None:
    drives = (judged(), judged(collisions=1), judged(teachers_laps=0.0))
    result = ExaminedOutcome(made_of=MADE_OF, seed=3, lesson=lesson(3, rlas=80), rlas_of={}, drives=drives)
    assert robot_score(result) == RobotScore(1, 3, result.lesson.presses, result.lesson.collisions, rlas=80)
    assert robot_score(result).passed_share == 1 / 3


def test_score_prefers_exams_then_little_effort() -> None:
    assert score_of([robot(2, 0), robot(3, 0)], PRESSES) < score_of([robot(3, 500), robot(3, 500)], PRESSES)
    assert score_of([robot(3, 9)], PRESSES) > score_of([robot(3, 10)], PRESSES)
    bumps = robot(3, 9, collisions=1)
    assert score_of([bumps], PRESSES) > score_of([robot(3, 10)], PRESSES)
    assert score_of([bumps], COLLISIONS) < score_of([robot(3, 18)], COLLISIONS)
    assert score_of([robot(3, 9, rlas=60)], RLAS) < score_of([robot(3, 99, rlas=50)], RLAS)


@examples(100)
@given(st.lists(st.tuples(st.integers(0, 3), st.integers(0, 10_000)), min_size=1, max_size=8), st.data())
def test_highest_score_is_never_reached(robots: list[tuple[int, int]], data: st.DataObject) -> None:
    scores = [robot(passed, presses) for passed, presses in robots]
    known = scores[: data.draw(st.integers(0, len(scores)))]
    assert score_of(scores, PRESSES) <= highest_score(known, 3 * len(scores))


@examples(100)
@given(st.lists(st.tuples(st.integers(0, 3), st.integers(0, 10_000)), min_size=2, max_size=2))
def test_one_more_exam_outweighs_any_effort(robots: list[tuple[int, int]]) -> None:
    (few, _), (more, _) = sorted(robots)
    low, high = (score_of([robot(passed, presses)], PRESSES) for passed, presses in sorted(robots))
    assert few == more or low < high
