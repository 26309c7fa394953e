from pathlib import Path

import pytest

from kurt2rt.experiments.compare import (
    SHIPPED,
    Pupil,
    PupilOutcome,
    Row,
    all_tables,
    draw_curves,
    holm,
    mcnemar_p,
    paired_table,
    sentence_of,
)
from kurt2rt.experiments.study.examination import Checkpoint
from tests.experiments.compare.test_compare import AFTER, plan_for
from tests.experiments.rows import MADE_OF, lesson
from tests.experiments.transfer.test_tables import DRIVES


def robot(seed: int, *there: str, failure: str = "", collisions: int = 0, presses: int = 8) -> PupilOutcome:
    """Return a robot whose exams after AFTER presses and at the end went like `there`, or the end alone."""
    return PupilOutcome(
        made_of=MADE_OF,
        seed=seed,
        lesson=lesson(seed, presses=presses, asks=5, corrections=3, collisions=collisions, rescues=0),
        failure=failure,
        checkpoints=tuple(
            Checkpoint(presses=after, teaching_s=after, lessons=after, drives=(DRIVES[what],))
            for after, what in zip((*AFTER, presses)[-len(there) :], there, strict=True)
        ),
    )


def comparison_of(*outcomes: tuple[PupilOutcome, ...]) -> tuple[Row, ...]:
    """Return the comparison of the RLA system as shipped and of 1-NN, with the outcomes of each."""
    pupils = (Pupil(SHIPPED), Pupil("1-nn"))
    return tuple(Row(("wall_following", pupil), own) for pupil, own in zip(pupils, outcomes, strict=True))


PLAN = plan_for(Path("never-made"), Pupil("1-nn"))


OURS = (robot(1, "stuck", "right", "right"), robot(2, "stuck", "stuck", "right"), robot(3, *["not judged"] * 3))
THEIRS = (
    robot(1, "right", "right", "stuck", collisions=2, presses=5),
    robot(2, "stuck", "stuck", "stuck", failure="1-nn: ValueError: empty", presses=7),
    robot(3, "right", "right", "right", collisions=1, presses=6),
)


def test_success_counts_judged_robots_by_presses() -> None:
    table = next(all_tables(comparison_of(OURS, THEIRS), PLAN))
    assert table.columns == ("task", "learner", "after 2", "after 5", "at the end")
    ours, theirs = table.rows
    assert ours[:2] == ("wall_following", "RLA, as shipped")
    assert [cell.partition(" (")[0] for cell in ours[2:]] == ["0 of 2", "1 of 2", "2 of 2"]
    assert [cell.partition(" (")[0] for cell in theirs[2:]] == ["2 of 3", "2 of 3", "1 of 3"]


def test_sentence_names_the_best_other_learner_if_there_is_one() -> None:
    alone = "Robots that pass: wall_following: 2 of 2 with the RLA system"
    assert sentence_of(comparison_of(OURS, THEIRS)) == f"{alone} and 1 of 3 with the best other, 1-NN without R."
    assert sentence_of((Row(("wall_following", Pupil(SHIPPED)), OURS),)) == f"{alone}."


def test_robots_without_a_verdict_have_no_share(tmp_path: Path) -> None:
    none = tuple(robot(seed, *["not judged"] * 3) for seed in (1, 2))
    comparison = comparison_of(none, none)
    assert next(all_tables(comparison, PLAN)).rows[0][2:] == ("none judged",) * 3
    draw_curves(comparison, PLAN.about, tmp_path / "empty.png")


def test_pairs_and_presses_are_compared_robot_by_robot() -> None:
    (row,) = paired_table(comparison_of(OURS, THEIRS)).rows
    assert row[:6] == ("wall_following", "1-NN without R", "2", "0", "0.500", "0.500")
    assert row[6] == "2.0 (-0.5 to 4.5)"  # 3, 1 and 2 fewer; Student's t of two degrees of freedom is 4.303
    (alone,) = paired_table(comparison_of(OURS[:1], THEIRS[:1])).rows
    assert alone[-1] == "-"


def test_failures_have_a_table_only_if_there_are_any() -> None:
    *_, failures = all_tables(comparison_of(OURS, THEIRS), PLAN)
    assert failures.rows == (("wall_following", "1-NN without R", "2", "1-nn: ValueError: empty"),)
    assert len(list(all_tables(comparison_of(OURS, OURS), PLAN))) == 3


@pytest.mark.parametrize(
    ("pairs", "p_value"),
    [
        ((0, 0), 1.0),
        ((3, 3), 1.0),
        ((1, 5), 14 / 64),  # 2 (1 + 6) / 2^6
        ((5, 1), 14 / 64),
        ((0, 10), 2 / 1024),
    ],
)
def test_mcnemar_is_the_two_sided_binomial_of_half(pairs: tuple[int, int], p_value: float) -> None:
    assert mcnemar_p(*pairs) == pytest.approx(p_value)


def test_holm_multiplies_by_the_tests_left_and_never_falls() -> None:
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert holm([0.5, 0.9]) == pytest.approx([1.0, 1.0])
    assert holm([]) == []
