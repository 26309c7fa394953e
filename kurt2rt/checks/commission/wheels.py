"""Step that checks side and direction of motors and encoders."""

from hal.kurt2_settings import Kurt2Settings
from hal.robot import WheelSpeeds
from kurt2rt.checks.commission.fault import FaultCode
from kurt2rt.checks.commission.operator import AnswerChoice, OperatorQuestion, QuestionKind, Tone
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
from kurt2rt.checks.commission.wiring import Motion, WheelSide, WheelTrial, parse_seen, single_side, wiring_faults

_UNEQUAL_SHARE = 0.25
_YES = "y"


class WheelsStep:
    """Step that turns each side both ways; the operator's eyes tell motors from encoders."""

    name = "wheels"
    title = "Each wheel's side and direction"
    why = "With sides exchanged or one reversed the robot turns into the wall it wants to leave."
    what_to_do = "Watch the wheels: three turn together on each side. Say which turned, and which way."
    moves = True
    blocks_driving = True

    async def run(self, stand: TestStand, findings: Findings) -> StepResult:
        """Drive each side both ways and ask for the observation; return the wiring and its faults.

        Raises SkippedError without a speed mode or if the operator refuses, AbortedError if the operator leaves,
        BusError.
        """
        mode = required_speed_mode(findings)
        result = StepResult(stand, findings)
        trials: list[WheelTrial] = []
        fastest_m_s: dict[WheelSide, float] = {}
        for side in WheelSide:
            for sign in (1, -1):
                ordered = single_side(side, sign)
                await confirm_motion(stand, f"The wheels of one side turn: {ordered}.")
                wanted = WheelSpeeds(ordered.left * TEST_SPEED_M_S, ordered.right * TEST_SPEED_M_S)
                drive = await stand.drive(mode, wanted, DRIVE_S)
                if not require_rest(stand, drive, result):
                    return result
                stood = standstill_cause(drive)
                speeds = steady_speeds(drive, stand.settings)
                counted = _counted(drive, stand.settings)
                seen = await _seen(stand, ordered, counted)
                trials.append(WheelTrial(ordered, seen, counted))
                fastest_m_s[side] = max(map(abs, speeds))
                result.note(
                    f"ordered {ordered}, seen {seen}, encoders {counted} "
                    f"({speeds.left_m_s:+.3f} and {speeds.right_m_s:+.3f} m/s)",
                )
                if stood is not None:
                    result.fail(FaultCode.WHEELS_HELD, drive=str(ordered), cause=stood)
        result.faults += wiring_faults(trials)
        if not result.faults and min(fastest_m_s.values()) < (1.0 - _UNEQUAL_SHARE) * max(fastest_m_s.values()):
            result.fail(FaultCode.SIDES_UNEQUAL)
        return result


def _counted(drive: TestDrive, robot: Kurt2Settings) -> Motion:
    return Motion(*(_sign(speed_m_s) for speed_m_s in steady_speeds(drive, robot)))


def _sign(speed_m_s: float) -> int:
    if abs(speed_m_s) < TURNS_SHARE * TEST_SPEED_M_S:
        return 0
    return 1 if speed_m_s > 0 else -1


async def _seen(stand: TestStand, ordered: Motion, counted: Motion) -> Motion:
    """Return the operator's observation.

    Enter alone is no answer: with motors and encoders exchanged only eyes tell. Nor is yes, if the encoders disagree
    with the command.
    """
    as_ordered = (AnswerChoice(_YES, f"yes, {ordered}"),) if counted == ordered else ()
    text = (
        f"Did the wheels turn: {ordered}? If not, type which did: left, right or both, forward or back; or none."
        if as_ordered
        else f"The encoders say: {counted}. Type what you saw: left, right or both, forward or back; or none."
    )
    question = OperatorQuestion(QuestionKind.SEEN, text, as_ordered, free=True)
    while True:
        answer = await stand.ask(question)
        if answer == _YES and as_ordered:
            return ordered
        seen = parse_seen(answer)
        if seen is not None:
            return seen
        yes = ", or y" if as_ordered else ""
        stand.tell(f"Two words, please, such as: left forward. Or: none{yes}.", Tone.BAD)
