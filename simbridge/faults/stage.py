"""Opens places with a fault."""

import random
from dataclasses import dataclass

from hal.robot_settings import RobotSettings
from simbridge.faults.disturbance import Kind, TimedFault
from simbridge.faults.parts import part_of
from simbridge.faults.place import SimulatedFaultRig


@dataclass(frozen=True, slots=True)
class FaultRigFactory:
    """A robot in a hall with one thing wrong; can be sent to another process."""

    settings: RobotSettings

    def open(
        self, target: str, kind: Kind, *, begin_s: float, end_s: float, period_s: float, delay_s: float, seed: int
    ) -> SimulatedFaultRig:
        """The place where `target` is disturbed from `begin_s` to `end_s`, give or take the seed's phase in a cycle.

        A target that is no part of the robot or its bus is left to the caller: the place's `disturbance` says when.
        """
        chance = random.Random(f"{target} {kind} {seed}")
        phase_s = chance.uniform(0.0, self.settings.can.cycle_s)
        disturbance = TimedFault(kind, begin_s + phase_s, end_s + phase_s, period_s, delay_s)
        return SimulatedFaultRig(self.settings, part_of(target), disturbance, chance)
