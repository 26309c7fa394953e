"""The same robots before and after."""

from kurt2rt.experiments.phases.outcome import Judgement
from kurt2rt.experiments.phases.summary import CriticScore, paired, score_of, worlds_of
from tests.experiments.phases.outcomes import exam, stage


def test_robots_are_compared_with_themselves_world_by_world() -> None:
    before = [stage("x", exam("a", progress=float(n)), exam("c", collisions=2, succeeded=False)) for n in range(10)]
    after = [stage("y", exam("c"), exam("a", progress=n + 1.0)) for n in range(10)]
    found = {(each.world, each.measure.name): each for each in paired(before, after)}
    progress = found["a", "progress"]
    assert (progress.before, progress.after) == (4.5, 5.5)
    assert progress.difference == (1.0, 1.0, 1.0)  # robots differ by 10, and the change is the same in all
    assert (progress.better, progress.worse) == (10, 0)
    collisions = found["c", "collisions in 10 min"]
    assert (collisions.before, collisions.after, collisions.better) == (4.0, 0.0, 10)
    assert collisions.surely_better
    assert not collisions.surely_worse
    assert found["c", "success"].surely_better


def test_paired_equal_stages_are_neither_better_nor_worse() -> None:
    robots = [stage("x", exam("a", collisions=n)) for n in range(5)]
    for each in paired(robots, robots):
        assert not each.surely_better
        assert not each.surely_worse
        assert each.better == each.worse == 0


def test_score_of_measures_precision_and_recall() -> None:
    told = [(-1, -1, 30), (-1, 0, 10), (0, -1, 20), (1, 1, 5), (1, None, 15), (0, 0, 20)]
    score = score_of([Judgement(judged=judged, said=said, ticks=ticks) for judged, said, ticks in told])
    assert (score.precision, score.recall, score.silent) == (0.6, 0.75, 0.15)
    assert score.agreement == (0.75 + 0.25) / 2
    assert score_of([]) == CriticScore(None, None, None, None)


def test_a_robot_that_was_stuck_once_or_more_counts_once() -> None:
    (world,) = worlds_of([stage("x", exam(rescues=rescues)) for rescues in (0, 1, 4)])
    assert world.stuck == 2
    assert (world.succeeded, world.robots) == (3, 3)
