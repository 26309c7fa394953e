"""Step that confirms that the wheels are off the ground."""

from kurt2rt.checks.commission.fault import SkipCode, SkippedError
from kurt2rt.checks.commission.findings import Findings
from kurt2rt.checks.commission.operator import SKIP, AnswerChoice, OperatorQuestion, QuestionKind, Tone
from kurt2rt.checks.commission.step import StepResult
from kurt2rt.checks.commission.test_stand import TestStand

WORDS = "wheels up"


class WheelsOffGroundStep:
    """Step of every session: yesterday's block proves nothing."""

    name = "lifted"
    title = "Wheels off the ground"
    why = "It is not known yet which way this robot turns its wheels, nor whether it stops on command."
    what_to_do = "Put the robot on a block so that all six wheels turn freely; cables, sleeves and fingers away."
    moves = False
    blocks_driving = True

    async def run(self, stand: TestStand, findings: Findings) -> StepResult:
        """Ask until the operator has typed that the wheels are off the ground.

        Raises SkippedError if the operator skips it, AbortedError if the operator leaves, BusError.
        """
        question = OperatorQuestion(
            QuestionKind.LIFTED,
            f"When no wheel touches anything, type: {WORDS}",
            (AnswerChoice(SKIP, "the wheels shall not turn today"),),
            free=True,
        )
        while True:
            answer = await stand.ask(question)
            if answer == SKIP:
                raise SkippedError(SkipCode.NOT_LIFTED)
            if " ".join(answer.split()) == WORDS:
                result = StepResult(findings)
                result.note("confirmed by typing")
                return result
            stand.tell(f"That was {answer!r}, not {WORDS!r}.", Tone.BAD)
