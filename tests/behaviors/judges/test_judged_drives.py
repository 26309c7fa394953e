"""Rewards of the judges for drives in the simulator, seen through the critic's perception."""

from collections import Counter

import pytest

from behaviors.policies.policy import ReferencePolicy
from behaviors.repertoire import load_repertoire
from hal.robot_settings import load_robot_of
from kurt2rt.core.basic.policy_level import PolicyLevel
from kurt2rt.core.decision.decision import ActiveBehaviour
from kurt2rt.core.task_settings import load_task
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.runtimes import NoTeachingAllowed
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runtime import RuntimeOptions, build_runtime
from simbridge.contracts.robot_kind import simulations_of
from tests.behaviors.helpers import ROBOT, counts

Shares = dict[int, float]


class Always:
    """Policy with a single action."""

    def __init__(self, action: str) -> None:
        self._action = action

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002
        return self._action


class BlindOnTheRight:
    """The eight's policy without the readings of the right: round the left column for ever."""

    def __init__(self) -> None:
        self._policy = load_task("eight").policy.build(ROBOT.infrared)
        on_the_right = [sensor.y_m < -0.05 for sensor in ROBOT.infrared.sensors]
        self._far = tuple(far for far, right in zip(counts(0.7), on_the_right, strict=True) if right)
        self._right = on_the_right

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:
        far = iter(self._far)
        seen = (next(far) if right else each for each, right in zip(infrared_counts, self._right, strict=True))
        return self._policy.choose(tuple(seen), behaviour)


async def judged(
    task_name: str,
    seconds: float,
    other: ReferencePolicy | None = None,
    since_s: float = 0.5,
    repertoire: str | None = None,
) -> Shares:
    """Return the fractions of the driven time after `since_s` by reward.

    `other` replaces the task's policy, `repertoire` its actions.
    """
    task, robot = load_task(task_name), load_robot_of(None, task_name)
    assert task.judge is not None
    judge = task.judge.build()
    simulation = simulations_of(robot).open(task.teaching.world, 1, "exam")
    wanted = ActiveBehaviour(task.behaviours)
    policy = task.policy.build(robot.infrared) if other is None else other
    level = PolicyLevel(policy, load_repertoire(repertoire or task.repertoire, robot), 10, wanted)
    clock = LockstepClock(simulation.step)
    runtime = build_runtime(
        simulation.robot,
        robot,
        task,
        (),
        NoTeachingAllowed(),
        clock,
        RuntimeOptions(level_override=level, active_behaviour=wanted),
    )
    heard: Counter[int] = Counter()

    def after_tick(record: TickRecord) -> None:
        if record.appraisal_features is not None and record.decision.driving and record.tick > 100 * since_s:
            heard[judge.judge(record.appraisal_features)] += 1

    await runtime.scheduler.run(round(seconds * 100), after_tick)
    simulation.close()
    return {value: heard[value] / heard.total() for value in (-1, 0, 1)}


OF_KURT2 = ("wall_following", "fleeing", "eight")
OF_OTHERS = ("school/wall_following", "school/fleeing", "turtlebot/wall_following", "turtlebot/fleeing")


@pytest.mark.parametrize("task", OF_KURT2)
async def test_judges_reward_the_teachers_own_drive(task: str) -> None:
    shares = await judged(task, seconds=8)
    assert shares[1] > 0.5
    assert shares[-1] < 0.02


@pytest.mark.deep
@pytest.mark.parametrize("task", [*OF_KURT2, *OF_OTHERS])
async def test_judges_reward_the_teachers_drive_for_minutes(task: str) -> None:
    shares = await judged(task, seconds=240)
    assert shares[1] > (0.55 if task in OF_KURT2 else 0.4)
    # The eight's policy keeps 3 cm more from a column than the one that its judge was chosen with.
    assert shares[-1] < (0.01 if task in ("wall_following", "fleeing") else 0.02)


@pytest.mark.parametrize(("task", "action"), [("eight", "back"), ("school/fleeing", "stand")])
async def test_judges_punish_standing_and_backing(task: str, action: str) -> None:
    basic = f"{task.rpartition('/')[0]}/basic".lstrip("/")  # not each repertoire of a task has these actions
    assert (await judged(task, seconds=3, other=Always(action), repertoire=basic))[-1] > 0.95


@pytest.mark.deep
async def test_eight_judge_punishes_circling_round_one_column() -> None:
    first_round = await judged("eight", seconds=16, other=BlindOnTheRight(), since_s=8)
    assert first_round[1] > 0.8
    assert first_round[-1] == 0.0
    later = await judged("eight", seconds=60, other=BlindOnTheRight(), since_s=32)
    assert later[-1] > 0.04  # wherever it passes the other column
    assert later[1] == 0.0
