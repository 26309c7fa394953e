"""Step: the wheels are off the ground, in the person's own words."""

from kurt2rt.checks.commission.findings import Findings
from kurt2rt.checks.commission.operator import SKIP, Asked, Choice, Question, SkippedError, Tone
from kurt2rt.checks.commission.step import Result
from kurt2rt.checks.commission.test_stand import Bench

WORDS = "wheels up"


class LiftedStep:
    """Asked anew in every session: a block that stood there yesterday proves nothing."""

    name = "lifted"
    title = "Wheels off the ground"
    why = "Nobody knows yet which way this robot turns its wheels, nor whether it stops when it is told to."
    what_to_do = "Put the robot on a block so that all six wheels turn freely; cables, sleeves and fingers away."
    moves = False
    bars_driving = True

    async def take(self, bench: Bench, findings: Findings) -> Result:
        """Ask until the words are typed."""
        question = Question(
            Asked.LIFTED,
            f"When no wheel touches anything, type: {WORDS}",
            (Choice(SKIP, "the wheels shall not turn today"),),
            free=True,
        )
        while True:
            answer = await bench.ask(question)
            if answer == SKIP:
                raise SkippedError("the wheels were not confirmed off the ground")
            if " ".join(answer.split()) == WORDS:
                result = Result(findings)
                result.note("confirmed by typing")
                return result
            bench.tell(f"That was {answer!r}, not {WORDS!r}.", Tone.BAD)
