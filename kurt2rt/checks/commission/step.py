"""A step of the checklist and what comes of it."""

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Protocol

from kurt2rt.checks.commission.findings import Findings
from kurt2rt.checks.commission.operator import Tone
from kurt2rt.checks.commission.test_stand import TestStand


class StepOutcome(StrEnum):
    """How a step ended."""

    PASSED = "passed"
    FAILED = "failed"
    SKIPPED = "skipped"


@dataclass(slots=True)
class StepResult:
    """What a step measured. It passed when nothing is left to do."""

    findings: Findings
    measured: list[str] = field(default_factory=list)
    to_do: list[str] = field(default_factory=list)
    """One instruction for each thing that is wrong."""

    unprinted: list[str] = field(default_factory=list)
    """Those of the measured lines that the person has not heard yet."""

    def note(self, line: str) -> None:
        """A measured line, for the end of the step."""
        self.measured.append(line)
        self.unprinted.append(line)

    def tell(self, stand: TestStand, line: str) -> None:
        """A measured line, told at once."""
        self.measured.append(line)
        stand.tell(line, Tone.MEASURED)

    @property
    def outcome(self) -> StepOutcome:
        """Passed or failed."""
        return StepOutcome.FAILED if self.to_do else StepOutcome.PASSED


class CommissionStep(Protocol):
    """One step. `run` may be called again; it then starts over."""

    name: str
    """What --only and --skip call it."""
    title: str
    why: str
    what_to_do: str
    moves: bool
    """True when the wheels turn."""
    blocks_driving: bool
    """True when a robot that failed here must not be driven, so that no settings file is written."""

    async def run(self, stand: TestStand, findings: Findings) -> StepResult:
        """Take the step; `findings` are those of the steps before. Raises SkippedError, LeftError, BusError."""
        ...
