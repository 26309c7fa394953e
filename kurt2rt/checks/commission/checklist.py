"""Checklist of the commissioning steps, with progress saved after each."""

from collections.abc import Callable, Sequence
from pathlib import Path

from anyio import to_thread

from config.settings import SettingsError
from hal.codec import hardware
from kurt2rt.checks.commission.bumpers import BumpersStep
from kurt2rt.checks.commission.fault import SkipCode, SkippedError
from kurt2rt.checks.commission.identity import IdentityStep
from kurt2rt.checks.commission.ir_calibration_step import IrCalibrationStep
from kurt2rt.checks.commission.operator import SKIP, AnswerChoice, OperatorQuestion, QuestionKind, Tone
from kurt2rt.checks.commission.progress import Findings, Progress, StepOutcome, StepRecord
from kurt2rt.checks.commission.sensors import SensorsStep
from kurt2rt.checks.commission.speed_modes import SpeedModesStep
from kurt2rt.checks.commission.step import CommissionStep, StepResult
from kurt2rt.checks.commission.stopping import StoppingStep
from kurt2rt.checks.commission.test_stand import TestStand
from kurt2rt.checks.commission.wheels import WheelsStep

WORDS = "wheels up"


class WheelsOffGroundStep:
    """Step in which the operator confirms that no wheel touches the ground; repeated in every session.

    Steps that turn the wheels are refused without it.
    """

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
                result = StepResult(stand, findings)
                result.note("confirmed by typing")
                return result
            stand.tell(f"That was {answer!r}, not {WORDS!r}.", Tone.BAD)


_OFF_GROUND = WheelsOffGroundStep()
STEPS: tuple[CommissionStep, ...] = (
    IdentityStep(),
    _OFF_GROUND,
    SpeedModesStep(),
    WheelsStep(),
    StoppingStep(),
    SensorsStep(),
    BumpersStep(),
    IrCalibrationStep(),
)
"""Steps in order; all that turn the wheels come while the robot is on its block."""
_AGAIN = "r"


class Checklist:
    """Execution of steps with an operator; the progress is saved after each step."""

    def __init__(self, stand: TestStand, progress: Progress, path: Path, who: str, now: Callable[[], str]) -> None:
        """`path`: of the progress file. `now`: returns date and time in UTC to the minute."""
        self._stand = stand
        self.progress = progress
        self._path = path
        self._who = who
        self._now = now
        self._wheels_are_up = False

    async def run(self, chosen: Sequence[CommissionStep], skipped: Sequence[CommissionStep] = ()) -> None:
        """Run the chosen steps in order and record the skipped ones.

        Raises AbortedError if the operator leaves, BusError if the bus is lost, OSError if the progress cannot be
        saved, and SettingsError if the findings belong to another robot.
        """
        await self._require_same_robot()
        for step in skipped:
            await self._skip(step, SkipCode.COMMAND_LINE, on_purpose=True)
        # Every session that turns wheels begins with the question about the block.
        moving = [step for step in chosen if step.moves]
        selected = [
            step for step in STEPS if step in chosen or (step is _OFF_GROUND and moving and step not in skipped)
        ]
        for number, step in enumerate(selected, 1):
            self._stand.tell(f"{number} of {len(selected)}: {step.title}  [{step.name}]", Tone.TITLE)
            self._stand.tell(f"Why: {step.why}")
            self._stand.tell(f"Do:  {step.what_to_do}")
            await self._run_step(step)

    async def _run_step(self, step: CommissionStep) -> None:
        again = True
        while again:
            try:
                result = await self._result(step)
            except SkippedError as skipped:
                self._stand.tell(f"skipped: {skipped.code.text}")
                await self._skip(step, skipped.code)
                return
            again = await self._judge(step, result)

    async def _result(self, step: CommissionStep) -> StepResult:
        if step.moves and not self._wheels_are_up:
            raise SkippedError(SkipCode.NOT_LIFTED)
        if step is not _OFF_GROUND:
            begin = OperatorQuestion(
                QuestionKind.BEGIN, "Ready?", (AnswerChoice("", "begin"), AnswerChoice(SKIP, "skip this step"))
            )
            if await self._stand.ask(begin) == SKIP:
                raise SkippedError(SkipCode.OPERATOR)
            await self._require_same_robot()
        result = await step.run(self._stand, self.progress.findings)
        if step is _OFF_GROUND:
            self._wheels_are_up = True
        return result

    async def _judge(self, step: CommissionStep, result: StepResult) -> bool:
        """Report and save the result; return whether to repeat the step."""
        record = StepRecord(
            outcome=result.outcome,
            at=self._now(),
            who=self._who,
            measured=tuple(result.measured),
            faults=tuple(result.faults),
        )
        await self._keep(step, record, result)
        if result.outcome is StepOutcome.PASSED:
            self._stand.tell(f"passed: {step.title}", Tone.GOOD)
            return False
        for line in record.to_do:
            self._stand.tell(line, Tone.TO_DO)
        self._stand.tell(f"FAILED: {step.title}", Tone.BAD)
        choices = (AnswerChoice(_AGAIN, "repeat it, when that is mended"), AnswerChoice("", "go on"))
        return (
            await self._stand.ask(OperatorQuestion(QuestionKind.AFTER_FAILURE, "Repeat this step?", choices)) == _AGAIN
        )

    async def _require_same_robot(self) -> None:
        """Raise SettingsError if the findings belong to another robot, perhaps a simulated one."""
        before = self.progress.findings.hardware_id
        if before is None:
            return
        now = await self._stand.hardware_id()
        if now is not None and now != before:
            raise SettingsError(
                f"is about a robot of {hardware(before)}, but INFO_1 says {hardware(now)}",
                where=self._path,
                do="give this robot another --name, or remove this file",
            )

    async def _skip(self, step: CommissionStep, code: SkipCode, *, on_purpose: bool = False) -> None:
        """Record a skipped step.

        An earlier pass stays. An earlier failure stays unless the operator skips it on purpose, which keeps its
        faults.
        """
        before = self.progress.steps.get(step.name)
        if before is not None and before.outcome is StepOutcome.PASSED:
            return
        if before is not None and before.outcome is StepOutcome.FAILED and not on_purpose:
            self._stand.tell(f"{step.title}: failed on {before.at}, and that stands", Tone.BAD)
            return
        record = StepRecord(
            outcome=StepOutcome.SKIPPED,
            at=self._now(),
            who=self._who,
            measured=(code.text,),
            faults=() if before is None else before.faults,
            skipped=code,
        )
        await self._keep(step, record)

    async def _keep(self, step: CommissionStep, record: StepRecord, result: StepResult | None = None) -> None:
        findings = self.progress.findings if result is None else result.findings
        self.progress = self.progress.with_step(step.name, record, findings)
        await to_thread.run_sync(self.progress.save, self._path)


def open_steps(progress: Progress) -> list[CommissionStep]:
    """Return the steps without an outcome, except the block under the wheels."""
    return [step for step in STEPS if step is not _OFF_GROUND and progress.outcome_of(step.name) is None]


def steps_to_run(progress: Progress) -> list[CommissionStep]:
    """Return the steps that have not passed, which a session runs by default."""
    passed = StepOutcome.PASSED
    return [step for step in STEPS if step is not _OFF_GROUND and progress.outcome_of(step.name) is not passed]


def blocking_failures(progress: Progress) -> list[CommissionStep]:
    """Return the failed steps that forbid driving this robot."""
    return [step for step in STEPS if step.blocks_driving and progress.outcome_of(step.name) is StepOutcome.FAILED]


def step_named(name: str) -> CommissionStep:
    """Return the step of a name. Raises KeyError for an unknown name."""
    return {step.name: step for step in STEPS}[name]
