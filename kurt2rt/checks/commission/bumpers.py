"""Step that finds the BUMPERC bit of each bumper."""

from functools import reduce
from operator import and_, or_

from kurt2rt.checks.commission.fault import FaultCode
from kurt2rt.checks.commission.listener import FrameStatistics
from kurt2rt.checks.commission.operator import SKIP, AnswerChoice, OperatorQuestion, QuestionKind, Tone
from kurt2rt.checks.commission.progress import Findings
from kurt2rt.checks.commission.step import StepResult
from kurt2rt.checks.commission.test_stand import TestStand

_SETTLE_S = 0.1
_LOOK_S = 0.3


class BumpersStep:
    """Step in which the operator presses one bumper after another."""

    name = "bumpers"
    title = "Each bumper's bit"
    why = "A pressed bumper forbids the wheels to turn its way; with the ends exchanged it would forbid the way out."
    what_to_do = "Press each bumper by hand as you are asked, and hold it for a second after Enter."
    moves = False
    blocks_driving = False

    async def run(self, stand: TestStand, findings: Findings) -> StepResult:
        """Ask the operator to press each bumper of the table; return the found bits and the faults.

        Raises AbortedError if the operator leaves, BusError.
        """
        bumpers = stand.settings.bumpers
        result = StepResult(stand, findings.model_copy(update={"bumper_bits": {}}))
        if not bumpers:
            result.note("the settings know no bumpers")
            return result
        await stand.ask(OperatorQuestion(QuestionKind.UNTOUCHED, "Touch no bumper.", (AnswerChoice("", "look"),)))
        await stand.listen(_SETTLE_S)
        heard = await stand.listen(_LOOK_S)
        if not heard.bumpers:
            result.fail(FaultCode.BUMPERS_SILENT)
            return result
        untouched = reduce(or_, heard.bumpers)
        if untouched:
            result.fail(FaultCode.BUMPER_HANGS, bits=_bits(untouched))
        found: dict[str, int] = {}
        for at, bumper in enumerate(bumpers):
            bit = await _find(stand, bumper.name, untouched, found)
            if bit is None:
                result.note(f"{bumper.name}: not found")
                result.fail(FaultCode.BUMPER_NOT_FOUND, bumper=bumper.name)
                continue
            found[bumper.name] = bit
            result.note(
                f"{bumper.name}: bit {bit}" + (", as the table says" if bit == at else f", the table says {at}")
            )
        result.findings = findings.model_copy(update={"bumper_bits": found})
        return result


async def _find(stand: TestStand, name: str, untouched: int, found: dict[str, int]) -> int | None:
    while True:
        question = OperatorQuestion(
            QuestionKind.BUMPER,
            f"Press and hold: {name}.",
            (AnswerChoice("", "look"), AnswerChoice(SKIP, "skip this one")),
            subject=name,
        )
        if await stand.ask(question) == SKIP:
            return None
        await stand.listen(_SETTLE_S)
        held = _held(await stand.listen(_LOOK_S)) & ~untouched
        if held.bit_count() != 1:
            seen = f"{_bits(held)} answered together" if held else "no bit answered"
            stand.tell(f"{seen}: press this bumper alone, and hold it", Tone.BAD)
            continue
        bit = held.bit_length() - 1
        owner = next((other for other, its in found.items() if its == bit), None)
        if owner is None:
            return bit
        stand.tell(f"bit {bit} answered, but that is {owner}'s: press {name}, or skip it and repeat the step", Tone.BAD)


def _held(heard: FrameStatistics) -> int:
    return reduce(and_, heard.bumpers) if heard.bumpers else 0


def _bits(bits: int) -> str:
    numbers = [str(bit) for bit in range(8) if bits >> bit & 1]
    return ("bit " if len(numbers) == 1 else "bits ") + ", ".join(numbers)
