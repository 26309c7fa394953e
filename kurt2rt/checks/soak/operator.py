"""Simulated operator who repositions a stuck robot and power-cycles it."""

import math

from kurt2rt.checks.soak.long_run_rig import SoakRig
from kurt2rt.core.decision.decision import BY_RLA, DecisionCause
from kurt2rt.core.teaching.commands import Resume
from kurt2rt.core.tick_record import TickRecord

_WAY_M = 0.3
_DRIVES = BY_RLA | {DecisionCause.TEACHER}


class SoakOperator:
    """Operator who repositions a robot that has not moved for too long though it wants to drive.

    If that does not help, the controller is power-cycled: a noise frame may have switched its motors off.
    """

    def __init__(self, rig: SoakRig, after_s: float, period_s: float) -> None:
        self.set_down = self.switched_on = 0
        """Numbers of repositionings and power cycles."""
        self._rig = rig
        self._most_ticks = round(after_s / period_s)
        self._ticks = 0
        self._from_m = rig.position_m
        self._has_moved = True
        self._resume_in_vain = False

    def on_tick(self, record: TickRecord) -> bool:
        """Count how long the robot has not moved; return whether it was repositioned after this tick.

        If the last repositioning did not help, its controller is power-cycled first. Call it after each tick.
        """
        if not record.guard_result.latched:
            self._resume_in_vain = False
        elif _was_resumed(record):
            self._resume_in_vain = True  # it stopped itself again in the very tick: where it is, no Go will help
        if (record.guard_result.latched and not self._resume_in_vain) or record.decision.cause not in _DRIVES:
            return False
        here_m = self._rig.position_m
        if math.dist(here_m, self._from_m) > _WAY_M:
            self._from_m, self._ticks = here_m, 0
            self._has_moved = True
            return False
        self._ticks += 1
        if self._ticks < self._most_ticks:
            return False
        if not self._has_moved:
            self._rig.power_cycle()
            self.switched_on += 1
        self._has_moved = self._resume_in_vain = False
        self._rig.reposition()
        self._from_m, self._ticks = self._rig.position_m, 0
        self.set_down += 1
        return True


def _was_resumed(record: TickRecord) -> bool:
    accepted = {result.command_id for result in record.results if result.accepted}
    return any(isinstance(each, Resume) and each.command_id in accepted for each in record.commands)
