"""Simulated robot in real time, as hardware for a runtime in another process."""

import random
from types import TracebackType
from typing import Self

from simbridge.realtime import RealtimeSimulation
from simbridge.robot_end import RobotEnd
from simbridge.worlds.world_settings import WorldSettings


class StandaloneRobot:
    """Running robot and the end of a link that it owns; it survives the loss of the link."""

    def __init__(
        self, world: WorldSettings, end: RobotEnd, seed: int, *, start: int | None = None, cycle_s: float = 0.01
    ) -> None:
        """Place a robot in a world, at its end of a link.

        Args: `seed` selects sensors, noise and, if `start` is None, the start pose; `start` counts from 1. `cycle_s`:
        duration of a cycle in s.
        """
        self.end = end
        chance = random.Random(f"on a bus in world {world.name}, seed {seed}")
        self.robot = end.simulate(world, chance.getrandbits(32), seed)
        starts = [each.pose for each in world.start_poses]
        self.robot.place(chance.choice(starts) if start is None else starts[start - 1])
        self.simulation = RealtimeSimulation(self.robot, cycle_s)

    def __enter__(self) -> Self:
        self.simulation.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.simulation.__exit__(kind, error, trace)
        finally:
            self.end.close()
