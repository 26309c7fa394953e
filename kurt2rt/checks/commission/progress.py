"""How far a commissioning has come, in a file: it may take days, and nobody types all of it twice."""

from collections.abc import Mapping
from pathlib import Path
from typing import Self

from pydantic import Field, ValidationError

from hal.settings import Settings, SettingsError
from kurt2rt.checks.commission.findings import Findings
from kurt2rt.checks.commission.step import StepOutcome
from kurt2rt.platform.durable_files import write_durably


class StepRecord(Settings):
    """How a step ended the last time it was taken."""

    outcome: StepOutcome
    at: str
    """Date and time, UTC, to the minute."""
    who: str
    measured: tuple[str, ...] = ()
    to_do: tuple[str, ...] = ()


class Progress(Settings):
    """One robot's commissioning."""

    name: str
    base: str
    """Settings that it began with."""
    bus: str
    findings: Findings = Findings()
    steps: Mapping[str, StepRecord] = Field(default={})
    """By the step's name."""

    def with_step(self, name: str, record: StepRecord, findings: Findings) -> Self:
        """The same after a step was taken."""
        return self.model_copy(update={"steps": {**self.steps, name: record}, "findings": findings})

    def save(self, path: Path) -> None:
        """Write durably, whole or not at all. Raises OSError."""
        write_durably(path, self.model_dump_json(indent=2) + "\n")


def load_progress(path: Path) -> Progress:
    """Read what `save` wrote. Raises SettingsError that says what to do, OSError."""
    try:
        return Progress.model_validate_json(path.read_text(encoding="utf-8"))
    except (UnicodeDecodeError, ValidationError) as error:
        first = " ".join(str(error).split())[:120]
        raise SettingsError(f"cannot be used ({first})", where=path, do="begin anew with --anew") from error
