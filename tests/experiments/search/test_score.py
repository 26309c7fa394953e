"""Scores: one more exam outweighs any effort."""

from hypothesis import given
from hypothesis import strategies as st

from kurt2rt.experiments.search.plan import highest_score, score_of
from kurt2rt.experiments.search.settings import Objective
from kurt2rt.experiments.study.jobs import ExaminedOutcome
from tests.examples import examples
from tests.experiments.rows import FAILED, MADE_OF, PASSED, lesson, row

PRESSES: Objective = "passed_then_presses"
COLLISIONS: Objective = "passed_then_presses_and_collisions"
RLAS: Objective = "passed_then_rlas"


def robot(passed: int, presses: int = 10, exams: int = 3, rlas: int = 50, collisions: int = 0) -> ExaminedOutcome:
    drives = tuple(row(verdict=PASSED if place < passed else FAILED) for place in range(exams))
    counts = lesson(1, presses=presses, collisions=collisions, rlas=rlas)
    return ExaminedOutcome(made_of=MADE_OF, seed=1, lesson=counts, rlas_of={}, drives=drives)


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
