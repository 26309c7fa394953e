"""Protocol and result of a checklist step."""

from dataclasses import dataclass, field
from typing import Protocol

from kurt2rt.checks.commission.fault import FaultCode, Field, StepFault
from kurt2rt.checks.commission.operator import Tone
from kurt2rt.checks.commission.progress import Findings, StepOutcome
from kurt2rt.checks.commission.test_stand import TestStand


@dataclass(slots=True)
class StepResult:
    """Result of a step: measured lines, findings and faults. The step passed if it found no fault."""

    stand: TestStand
    findings: Findings
    measured: list[str] = field(default_factory=list)
    faults: list[StepFault] = field(default_factory=list)

    def fail(self, code: FaultCode, **fields: Field) -> None:
        """Add a fault of a code; `fields` fill the gaps in the code's text."""
        self.faults.append(StepFault(code, fields))

    def note(self, line: str) -> None:
        """Add a measured line, and show it to the operator."""
        self.measured.append(line)
        self.stand.tell(line, Tone.MEASURED)

    @property
    def outcome(self) -> StepOutcome:
        """PASSED without a fault, else FAILED."""
        return StepOutcome.FAILED if self.faults else StepOutcome.PASSED


class CommissionStep(Protocol):
    """Step of the commissioning's checklist, with its texts. `run` starts over at each call."""

    name: str
    """Name for --only and --skip."""
    title: str
    why: str
    what_to_do: str
    moves: bool
    """True if the wheels turn."""
    blocks_driving: bool
    """True if a failure forbids driving, so that no settings file is written."""

    async def run(self, stand: TestStand, findings: Findings) -> StepResult:
        """Run the step with the findings so far; return its measurements, findings and faults.

        Raises SkippedError if the step cannot or shall not run, AbortedError if the operator leaves, BusError.
        """
        ...
