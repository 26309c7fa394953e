"""Common parts of the steps that turn the wheels."""

from hal.robot import WheelSpeeds
from hal.robot_settings import RobotSettings, SpeedMode
from kurt2rt.checks.commission.findings import Findings
from kurt2rt.checks.commission.operator import SKIP, AnswerChoice, OperatorQuestion, QuestionKind, SkippedError, Tone
from kurt2rt.checks.commission.step import StepResult
from kurt2rt.checks.commission.test_stand import TestDrive, TestStand

TEST_SPEED_M_S = 0.15
DRIVE_S = 1.2
STEADY_FRAMES = 30
"""Frames at the end of a drive with constant speed."""


async def confirm_motion(stand: TestStand, text: str) -> None:
    """Ask before the wheels turn. Raises SkippedError."""
    question = OperatorQuestion(
        QuestionKind.MOVE, text, (AnswerChoice("", "turn them"), AnswerChoice(SKIP, "do not turn them"))
    )
    if await stand.ask(question) == SKIP:
        raise SkippedError("the wheels were not to turn")


def required_speed_mode(findings: Findings) -> SpeedMode:
    """Return the speed mode that answered. Raises SkippedError if none is known."""
    if findings.speed_mode is None:
        raise SkippedError("no speed mode is known to answer: take the step modes first")
    return findings.speed_mode


def steady_speeds(drive: TestDrive, robot: RobotSettings) -> WheelSpeeds:
    """Return the measured wheel speeds before the brake."""
    return drive.heard.wheel_speeds(robot, STEADY_FRAMES)


def standstill_cause(drive: TestDrive) -> str | None:
    """Return why the guard kept the wheels from turning; None if they could turn."""
    if drive.stopped_by is not None:
        return drive.stopped_by
    if drive.applied == WheelSpeeds(0.0, 0.0):
        return ", ".join(drive.reasons) or "set point too small for this mode"
    return None


def require_rest(stand: TestStand, drive: TestDrive, result: StepResult) -> bool:
    """Return whether the brake stopped the wheels; otherwise alarm the operator, and the step must end."""
    if drive.rested_after_s is not None:
        return True
    heard = "still turn" if drive.after.encoder else "are not heard of any more"
    result.to_do.append(f"The wheels {heard} after the brake: SWITCH THE MOTORS OFF, then look for the reason")
    stand.tell(result.to_do[-1], Tone.BAD)
    return False
