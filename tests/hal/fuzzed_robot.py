"""Robot in simulated time, with a fuzzing node on its bus."""

import itertools
import math
import os
import random
from types import TracebackType
from typing import Self

from behaviors.repertoire import load_repertoire
from hal.bus import CanInterface, open_bus
from hal.in_process_bus import InProcessBus
from hal.kurt2 import Kurt2
from hal.shared_bus import SharedBus
from kurt2rt.core.basic.policy_level import PolicyLevel
from kurt2rt.core.decision.decision import ActiveBehaviour
from kurt2rt.core.task_settings import load_task
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.runtimes import NoTeachingAllowed
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runtime import RuntimeOptions, build_runtime
from simbridge.simulated_robot import SimulatedKurt2
from simbridge.worlds.world_loading import load_world
from tests.hal.fuzz_frames import FuzzFrames
from tests.hal.helpers import ROBOT, TICK_S
from tests.hal.onlooker import Onlooker

_numbers = itertools.count()


class FuzzedRobot:
    """The runtime drives by the teacher's policy; stopped, it is released before long."""

    def __init__(self, kind: str, seed: int) -> None:
        """`kind` of the bus: virtual or shared."""
        name = f"can-fuzz-{os.getpid()}-{next(_numbers)}"
        spec = f"{kind}:{name}"
        self._stranger: CanInterface = InProcessBus(name) if kind == "virtual" else SharedBus(name)
        self._stranger.set_id_filter(frozenset())
        self._controller_bus = open_bus(spec)
        robot_bus = open_bus(spec)
        self.onlooker = robot_bus.tap = Onlooker()
        self.kurt2 = Kurt2(ROBOT, robot_bus)
        self.simulation = SimulatedKurt2(ROBOT, load_world("a", ROBOT), self._controller_bus, seed)
        self.bad_frames = 0
        self._spells = FuzzFrames(seed, fd=kind == "virtual").spells()
        self._chance = random.Random(seed)
        task = load_task("wall_following")
        level = PolicyLevel(
            task.policy.build(ROBOT.infrared),
            load_repertoire(task.repertoire, ROBOT),
            round(task.learning.minimum_action_s / TICK_S),
            ActiveBehaviour(),
        )
        clock = LockstepClock(self._step)
        runtime = build_runtime(
            self.kurt2, ROBOT, task, [], NoTeachingAllowed(), clock, RuntimeOptions(level_override=level)
        )
        self._scheduler = runtime.scheduler

    async def drive(self, bad_frames: int) -> None:
        """Drive until so many bad frames have been sent; raises whatever comes out of a tick or of the onlooker."""
        until = self.bad_frames + bad_frames
        while self.bad_frames < until:
            await self._scheduler.run(100, self._judge)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.kurt2.close()
        self._controller_bus.shutdown()
        self._stranger.shutdown()

    def _step(self) -> None:
        self.simulation.step()
        frames = next(self._spells)
        for frame in frames:
            self._stranger.send(frame, 0)
        self.bad_frames += len(frames)
        while self._stranger.recv(0) is not None:  # the queue of this end must not fill up
            pass
        if self._chance.random() < 0.3:
            self.kurt2.release()

    def _judge(self, record: TickRecord) -> None:
        self.onlooker.judge(record.now_s, record.guard_result)
        assert all(0 <= counts <= 1023 for counts in record.readings.infrared_counts)
        orders = self.simulation.controller.commands
        assert math.isfinite(orders.left_m_s)
        assert math.isfinite(orders.right_m_s)
