"""The runtime as a process, its teacher's own policy at the wheels: `python -m ...runtime BUS SECONDS [HANGS_AT_TICK]`.

In that tick its decision takes a second. At its end it tells how many ticks there were, and each at which the guard
had other reasons than in the one before.
"""

import json
import sys
import time

import anyio

from behaviors.repertoire import load_repertoire
from hal.bus import open_bus
from hal.kurt2 import Kurt2
from hal.kurt2_settings import load_kurt2
from hal.robot import SensorReadings
from kurt2rt.core.basic.policy_level import PolicyLevel
from kurt2rt.core.decision.decision import ActiveBehaviour, Decision, DecisionCause
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.task_settings import load_task
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.runtimes import NoTeachingAllowed
from kurt2rt.platform.timerfd_clock import TimerfdClock
from kurt2rt.runtime import RuntimeOptions, build_runtime

HANG_S = 1.0


class Hanging(PolicyLevel):
    """The policy, which takes its time once."""

    hangs_at = 0
    decisions = 0

    def decide(self, situation: Situation, readings: SensorReadings, stand_because: DecisionCause | None) -> Decision:
        self.decisions += 1
        if self.decisions == self.hangs_at:
            print(json.dumps({"hangs_from_s": time.time()}), flush=True)
            time.sleep(HANG_S)
        return super().decide(situation, readings, stand_because)


async def drive(bus: str, seconds: float, hangs_at: int) -> None:
    settings, task = load_kurt2(), load_task("wall_following")
    policy = task.policy.build(settings.infrared)
    period_s = settings.cycle_s
    level = Hanging(
        policy,
        load_repertoire(task.repertoire, settings),
        round(task.learning.minimum_action_s / period_s),
        ActiveBehaviour(),
    )
    level.hangs_at = hangs_at
    robot = Kurt2(settings, open_bus(bus))
    turns: list[dict[str, object]] = []
    before: tuple[str, ...] = ()

    def after_tick(record: TickRecord) -> None:
        nonlocal before
        reasons = tuple(reason for reason in record.guard_result.reasons if not reason.routine)
        if reasons != before:
            before = reasons
            turns.append({"tick": record.tick, "reasons": reasons, "infrared_age_s": record.readings.infrared_age_s})

    with TimerfdClock() as clock, robot.watchdog:
        runtime = build_runtime(
            robot, settings, task, (), NoTeachingAllowed(), clock, RuntimeOptions(level_override=level)
        )
        await runtime.scheduler.run(round(seconds / period_s), after_tick)
    robot.close()
    timer = runtime.timer
    print(json.dumps({"ticks": timer.ticks, "missed": timer.missed_ticks, "turns": turns}))


if __name__ == "__main__":
    anyio.run(drive, sys.argv[1], float(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else 0)
