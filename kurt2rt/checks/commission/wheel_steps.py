"""Common parts of the steps that turn the wheels."""

from hal.kurt2_settings import Kurt2Settings, SpeedMode
from hal.robot import WheelSpeeds
from kurt2rt.checks.commission.fault import FaultCode, SkipCode, SkippedError, StepFault
from kurt2rt.checks.commission.operator import SKIP, AnswerChoice, OperatorQuestion, QuestionKind, Tone
from kurt2rt.checks.commission.progress import Findings
from kurt2rt.checks.commission.step import StepResult
from kurt2rt.checks.commission.test_stand import TestDrive, TestStand

TEST_SPEED_M_S = 0.15
DRIVE_S = 1.2
STEADY_FRAMES = 30
"""Frames at the end of a drive with constant speed."""


async def confirm_motion(stand: TestStand, text: str) -> None:
    """Ask the operator before the wheels turn; `text` tells the motion.

    Raises SkippedError if the operator refuses the motion, AbortedError if the operator leaves, BusError.
    """
    question = OperatorQuestion(
        QuestionKind.MOVE, text, (AnswerChoice("", "turn them"), AnswerChoice(SKIP, "do not turn them"))
    )
    if await stand.ask(question) == SKIP:
        raise SkippedError(SkipCode.NO_MOTION)


def required_speed_mode(findings: Findings) -> SpeedMode:
    """Return the speed mode that answered in an earlier step. Raises SkippedError if none is known."""
    if findings.speed_mode is None:
        raise SkippedError(SkipCode.NO_SPEED_MODE)
    return findings.speed_mode


def steady_speeds(drive: TestDrive, robot: Kurt2Settings) -> WheelSpeeds:
    """Return the mean wheel speeds that were measured before the brake of a test drive, in m/s."""
    return drive.heard.wheel_speeds(robot, STEADY_FRAMES)


def standstill_cause(drive: TestDrive) -> str | None:
    """Return the reason that the guard kept the wheels from turning; None if they could turn."""
    if drive.stopped_by is not None:
        return drive.stopped_by
    if drive.applied == WheelSpeeds(0.0, 0.0):
        return ", ".join(drive.reasons) or "set point too small for this mode"
    return None


def require_rest(stand: TestStand, drive: TestDrive, result: StepResult) -> bool:
    """Return whether the brake stopped the wheels after a test drive.

    If not, a fault is added to `result` and the operator is alarmed; the step must end then.
    """
    if drive.rested_after_s is not None:
        return True
    fault = StepFault(FaultCode.BRAKE_FAILS if drive.after.encoder else FaultCode.BRAKE_UNHEARD)
    result.faults.append(fault)
    stand.tell(fault.text, Tone.BAD)
    return False
