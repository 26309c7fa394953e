"""Progress of a commissioning in a file, so that it can take several sessions."""

from collections.abc import Mapping
from pathlib import Path
from typing import Self

from pydantic import Field, ValidationError

from config.settings import Settings, SettingsError
from kurt2rt.checks.commission.fault import SkipCode, StepFault
from kurt2rt.checks.commission.findings import Findings
from kurt2rt.checks.commission.step import StepOutcome
from kurt2rt.platform.durable_files import write_durably


class StepRecord(Settings):
    """Result of the last run of a step."""

    outcome: StepOutcome
    at: str
    """Date and time, UTC, to the minute."""
    who: str
    measured: tuple[str, ...] = ()
    to_do: tuple[str, ...] = ()
    """Instruction for each fault, in words."""
    faults: tuple[StepFault, ...] = ()
    skipped: SkipCode | None = None


class Progress(Settings):
    """State of a commissioning between sessions: findings and passed steps, stored as YAML."""

    name: str
    base: str
    """Settings that it began with."""
    bus: str
    findings: Findings = Findings()
    steps: Mapping[str, StepRecord] = Field(default={})
    """Records by step name."""

    def with_step(self, name: str, record: StepRecord, findings: Findings) -> Self:
        """Return a copy of the progress with the record of the step `name`, and with all findings so far."""
        return self.model_copy(update={"steps": {**self.steps, name: record}, "findings": findings})

    def save(self, path: Path) -> None:
        """Write the progress to a file, atomically and durably. Raises OSError."""
        write_durably(path, self.model_dump_json(indent=2) + "\n")


def load_progress(path: Path) -> Progress:
    """Load a file of `Progress.save`. Raises SettingsError if it is damaged, OSError if it cannot be read."""
    try:
        return Progress.model_validate_json(path.read_text(encoding="utf-8"))
    except (UnicodeDecodeError, ValidationError) as error:
        first = " ".join(str(error).split())[:120]
        raise SettingsError(f"cannot be used ({first})", where=path, do="remove it to start over") from error
