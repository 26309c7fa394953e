"""Step that checks the brake and the controller's own watchdog."""

import statistics

from hal.robot import WheelSpeeds
from kurt2rt.checks.commission.fault import FaultCode
from kurt2rt.checks.commission.progress import Findings
from kurt2rt.checks.commission.step import StepResult
from kurt2rt.checks.commission.test_stand import TURNS_SHARE, TestDrive, TestStand
from kurt2rt.checks.commission.wheel_steps import (
    DRIVE_S,
    TEST_SPEED_M_S,
    confirm_motion,
    require_rest,
    required_speed_mode,
    standstill_cause,
    steady_speeds,
)

BRAKED_WITHIN_S = 0.5
SILENT_S = 1.5
_FALLEN_SHARE = 0.8
_FORWARD = WheelSpeeds(TEST_SPEED_M_S, TEST_SPEED_M_S)


class StoppingStep:
    """Step that brakes the turning wheels, then stops sending, and measures the time to rest of each.

    The second part checks the watchdog of the controller, which stops the robot if this computer fails.
    """

    name = "stop"
    title = "Emergency stop and the controller's own watchdog"
    why = "The brake is what every fault ends in. The watchdog is all that stops the robot when this computer dies."
    what_to_do = f"All wheels turn forward at {TEST_SPEED_M_S} m/s, twice: once they are braked, once left alone."
    moves = True
    blocks_driving = True

    async def run(self, stand: TestStand, findings: Findings) -> StepResult:
        """Brake while driving, then stop sending while driving; return the measured times and faults.

        Raises SkippedError without a speed mode or if the operator refuses, AbortedError if the operator leaves,
        BusError.
        """
        mode = required_speed_mode(findings)
        result = StepResult(stand, findings.model_copy(update={"controller_watchdog_s": None}))
        await confirm_motion(stand, "All wheels turn forward; then the brake.")
        drive = await stand.drive(mode, _FORWARD, DRIVE_S)
        rested_s = drive.rested_after_s
        if not require_rest(stand, drive, result) or rested_s is None:
            return result
        if _was_turning(stand, drive, result):
            result.note(f"braked: the wheels stood {rested_s * 1000:.0f} ms after the frame")
            if rested_s > BRAKED_WITHIN_S:
                result.fail(FaultCode.BRAKE_SLOW, took_s=rested_s, most_s=BRAKED_WITHIN_S)
        await confirm_motion(stand, f"All wheels turn forward; then nothing is sent for at most {SILENT_S} s.")
        drive = await stand.stop_sending(mode, _FORWARD, DRIVE_S, SILENT_S)
        if _was_turning(stand, drive, result):
            _judge_watchdog(stand, drive, result)
        return result


def _was_turning(stand: TestStand, drive: TestDrive, result: StepResult) -> bool:
    stood = standstill_cause(drive)
    if stood is None and max(map(abs, steady_speeds(drive, stand.settings))) < TURNS_SHARE * TEST_SPEED_M_S:
        stood = "no answer to the set point"
    if stood is not None:
        result.fail(FaultCode.NOTHING_TO_STOP, cause=stood)
    return stood is None


def _judge_watchdog(stand: TestStand, drive: TestDrive, result: StepResult) -> None:
    if drive.rested_after_s is None:
        result.fail(FaultCode.WATCHDOG_MISSING, silent_s=SILENT_S)
        return
    fell_s = _fell_after_s(stand, drive)
    result.note(
        f"without CONTROL: the drive dropped out after {fell_s * 1000:.0f} ms, "
        f"the wheels stood after {drive.rested_after_s * 1000:.0f} ms",
    )
    result.findings = result.findings.model_copy(update={"controller_watchdog_s": round(fell_s, 2)})


def _fell_after_s(stand: TestStand, drive: TestDrive) -> float:
    """Return the time from the last CONTROL to the first clearly slower ENCODER frame."""
    before = drive.heard.encoder[-30:]
    steady_ticks = statistics.mean(abs(each.left) + abs(each.right) for each in before)
    from_s = drive.heard.encoder[-1].time_s
    for frame in drive.after.encoder:
        if abs(frame.left) + abs(frame.right) < _FALLEN_SHARE * steady_ticks:
            return max(stand.settings.cycle_s, frame.time_s - from_s)
    return drive.rested_after_s or 0.0
