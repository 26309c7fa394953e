"""Factory of fault rigs."""

import random
from dataclasses import dataclass

from hal.robot_settings import RobotSettings
from simbridge.faults.disturbance import Kind, TimedFault
from simbridge.faults.parts import part_of
from simbridge.faults.place import SimulatedFaultRig


@dataclass(frozen=True, slots=True)
class FaultRigFactory:
    """Factory of robots in a corridor with one fault; picklable."""

    settings: RobotSettings

    def open(
        self, target: str, kind: Kind, *, begin_s: float, end_s: float, period_s: float, delay_s: float, seed: int
    ) -> SimulatedFaultRig:
        """Return a rig with a fault from `begin_s` to `end_s`, shifted by the seed's phase within a cycle.

        A target that is no part of robot or bus is left to the caller; the rig's `disturbance` has the times.
        """
        chance = random.Random(f"{target} {kind} {seed}")
        phase_s = chance.uniform(0.0, self.settings.can.cycle_s)
        disturbance = TimedFault(kind, begin_s + phase_s, end_s + phase_s, period_s, delay_s)
        return SimulatedFaultRig(self.settings, part_of(target), disturbance, chance)
