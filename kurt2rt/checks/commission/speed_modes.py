"""Step that finds the firmware's working speed mode."""

import math
from dataclasses import dataclass, field

from hal.kurt2_settings import Kurt2Settings, SpeedMode
from hal.robot import WheelSpeeds
from kurt2rt.checks.commission.fault import FaultCode, SkippedError, StepFault
from kurt2rt.checks.commission.progress import Findings
from kurt2rt.checks.commission.step import StepResult
from kurt2rt.checks.commission.test_stand import RAN_AWAY, TURNS_SHARE, TestDrive, TestStand
from kurt2rt.checks.commission.wheel_steps import (
    DRIVE_S,
    TEST_SPEED_M_S,
    confirm_motion,
    require_rest,
    standstill_cause,
    steady_speeds,
)

PREFERENCE = (SpeedMode.SPEED_CM, SpeedMode.SPEED, SpeedMode.RAW)
"""Order of preference: closed loops before the open one, the finer SPEED_CM first."""
_ACCURATE = (0.6, 1.6)
"""Allowed ratio of measured and commanded speed; outside of it settings and robot differ."""
_TURNS_M_S = TURNS_SHARE * TEST_SPEED_M_S


class SpeedModesStep:
    """Step that drives each mode slowly forward and backward, and reads the encoders."""

    name = "modes"
    title = "Which speed mode answers?"
    why = "Old firmware lacks SPEED_CM, newer firmware may lack SPEED, and there is no acknowledge: only wheels tell."
    what_to_do = f"Each mode turns all wheels at {TEST_SPEED_M_S} m/s, {DRIVE_S} s forward and {DRIVE_S} s backward."
    moves = True
    blocks_driving = True

    async def run(self, stand: TestStand, findings: Findings) -> StepResult:
        """Try all speed modes; the first of PREFERENCE that answers is the finding.

        Raises SkippedError if the operator refuses the motion, AbortedError if the operator leaves, BusError.
        """
        robot = stand.settings
        result = StepResult(stand, findings.model_copy(update={"speed_mode": None, "full_speed_m_s": None}))
        trials: list[_Trial] = []
        for mode in PREFERENCE:
            try:
                await confirm_motion(stand, f"All wheels turn forward, then backward: mode {mode}.")
            except SkippedError:
                result.note(f"{mode}: left out")
                continue
            trial = _Trial(mode)
            for sign in (1.0, -1.0):
                drive = await stand.drive(mode, WheelSpeeds(sign * TEST_SPEED_M_S, sign * TEST_SPEED_M_S), DRIVE_S)
                trial.drives.append(drive)
                if not require_rest(stand, drive, result):
                    return result
                if standstill_cause(drive) is not None:
                    break
            result.note(trial.text(robot))
            trials.append(trial)
        return _conclude(trials, robot, result)


@dataclass(slots=True)
class _Trial:
    """Drives in one mode: forward and, unless cut short, backward."""

    mode: SpeedMode
    drives: list[TestDrive] = field(default_factory=list)

    def standstill_cause(self) -> str | None:
        """Return why the wheels were kept from turning."""
        return next((why for why in map(standstill_cause, self.drives) if why is not None), None)

    def answers(self, robot: Kurt2Settings) -> bool:
        """Return whether the wheels turned both ways."""
        return self.standstill_cause() is None and all(
            _fastest_m_s(drive, robot) >= _TURNS_M_S for drive in self.drives
        )

    def share(self, robot: Kurt2Settings) -> float:
        """Return the ratio of measured and commanded speed of the faster side."""
        measured_m_s = sum(_fastest_m_s(drive, robot) for drive in self.drives) / len(self.drives)
        return measured_m_s / abs(self.drives[0].applied.left_m_s)

    def full_speed_m_s(self, robot: Kurt2Settings) -> float:
        """Return the speed at 100 % in SPEED mode."""
        return round(robot.motors.full_speed_m_s * self.share(robot), 3)

    def text(self, robot: Kurt2Settings) -> str:
        """Return the result in one line."""
        stood = self.standstill_cause()
        if stood is not None:
            return f"{self.mode}: not tried out, {stood}"
        if not self.answers(robot):
            one_way = any(_fastest_m_s(drive, robot) >= _TURNS_M_S for drive in self.drives)
            return f"{self.mode}: " + ("answers in one direction only" if one_way else "no answer")
        told_m_s = abs(self.drives[0].applied.left_m_s)
        said = f"{self.mode}: answers, {told_m_s * self.share(robot):.3f} m/s for a set point of {told_m_s:.3f} m/s"
        return said + (f"; 100 % are {self.full_speed_m_s(robot):.2f} m/s" if self.mode is SpeedMode.SPEED else "")

    def fault(self, robot: Kurt2Settings) -> StepFault | None:
        """Return the fault of a mode that the firmware knows."""
        stood = self.standstill_cause()
        if stood == RAN_AWAY:
            return StepFault.of(FaultCode.MODE_RAN_AWAY, mode=self.mode.value, cause=stood)
        if stood is not None:
            return StepFault.of(FaultCode.WHEELS_HELD, drive=self.mode.value, cause=stood)
        if not self.answers(robot) or _ACCURATE[0] <= self.share(robot) <= _ACCURATE[1]:
            return None
        ticks = math.tau * robot.geometry.wheel_radius_m / robot.geometry.metres_per_tick
        return StepFault.of(FaultCode.MODE_SPEED, mode=self.mode.value, ratio=self.share(robot), ticks=ticks)


def _conclude(trials: list[_Trial], robot: Kurt2Settings, result: StepResult) -> StepResult:
    """Take the first mode that answers; faults of later modes do not matter."""
    for trial in trials:
        fault = trial.fault(robot)
        if fault is not None:
            result.faults.append(fault)
        if trial.answers(robot):
            update: dict[str, object] = {"speed_mode": trial.mode}
            if trial.mode is SpeedMode.SPEED:
                update["full_speed_m_s"] = trial.full_speed_m_s(robot)
            result.findings = result.findings.model_copy(update=update)
            result.note(f"the robot will be driven in {trial.mode}")
            return result
    result.fail(FaultCode.MODE_MISSING)
    return result


def _fastest_m_s(drive: TestDrive, robot: Kurt2Settings) -> float:
    return max(map(abs, steady_speeds(drive, robot)))
