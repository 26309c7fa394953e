"""What the steps that turn the wheels have in common: leave to turn them, how fast, how long, and what stood still."""

from hal.robot import WheelSpeeds
from hal.robot_settings import RobotSettings, SpeedMode
from kurt2rt.checks.commission.findings import Findings
from kurt2rt.checks.commission.operator import SKIP, Asked, Choice, Question, SkippedError, Tone
from kurt2rt.checks.commission.step import Result
from kurt2rt.checks.commission.test_stand import Bench, Drive

TEST_SPEED_M_S = 0.15
DRIVE_S = 1.2
STEADY_FRAMES = 30
"""At the end of a drive, when the wheels have their speed."""


async def leave_to_move(bench: Bench, text: str) -> None:
    """Ask before wheels turn. Raises SkippedError."""
    question = Question(Asked.MOVE, text, (Choice("", "turn them"), Choice(SKIP, "do not turn them")))
    if await bench.ask(question) == SKIP:
        raise SkippedError("the wheels were not to turn")


def mode_found(findings: Findings) -> SpeedMode:
    """The mode that answered. Raises SkippedError when that is not known."""
    if findings.speed_mode is None:
        raise SkippedError("no speed mode is known to answer: take the step modes first")
    return findings.speed_mode


def steady(drive: Drive, robot: RobotSettings) -> WheelSpeeds:
    """Speeds of the wheels by the encoders before the brake."""
    return drive.heard.wheel_speeds(robot, STEADY_FRAMES)


def why_it_stood(drive: Drive) -> str | None:
    """Why the guard let nothing through; None when it did."""
    if drive.stopped_by is not None:
        return drive.stopped_by
    if drive.applied == WheelSpeeds(0.0, 0.0):
        return ", ".join(drive.reasons) or "set point too small for this mode"
    return None


def rests(bench: Bench, drive: Drive, result: Result) -> bool:
    """Whether the brake brought the wheels to rest; says at once what to do when not. No step goes on then."""
    if drive.rested_after_s is not None:
        return True
    heard = "still turn" if drive.after.encoder else "are not heard of any more"
    result.to_do.append(f"The wheels {heard} after the brake: SWITCH THE MOTORS OFF, then look for the reason")
    bench.tell(result.to_do[-1], Tone.BAD)
    return False
