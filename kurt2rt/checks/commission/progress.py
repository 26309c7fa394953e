"""Findings and progress of a commissioning, in a file, so that it can take several sessions."""

from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, ValidationError

from config.settings import Settings, SettingsError
from hal.kurt2_settings import SpeedMode
from kurt2rt.checks.commission.fault import SkipCode, StepFault
from kurt2rt.platform.durable_files import write_durably


class LawFound(Settings):
    """Infra-red calibration that a commissioning found, for the robot's settings file.

    It holds between `near_m` and `far_m`; floor and plateau are the counts beyond both.
    """

    numerator_counts_m: float
    offset_m: float
    bias_counts: float
    near_m: float
    far_m: float
    floor_counts: int
    plateau_counts: int


class Findings(Settings):
    """Values that a commissioning measured, for the robot's settings file.

    None or absent: not measured, the base settings hold.
    """

    hardware_id: int | None = None
    firmware: int | None = None
    speed_mode: SpeedMode | None = None
    full_speed_m_s: float | None = None
    """Speed at 100 % in SPEED mode, if that mode answered."""
    controller_watchdog_s: Annotated[float, Field(gt=0)] | None = None
    channels: Mapping[str, str] = Field(default={})
    """Analog channel by sensor name."""
    dead_sensors: tuple[str, ...] = ()
    bumper_bits: Mapping[str, int] = Field(default={})
    """Bit by bumper name."""
    law: LawFound | None = None


class StepOutcome(StrEnum):
    """Outcome of the last run of a commissioning step."""

    PASSED = "passed"
    FAILED = "failed"
    SKIPPED = "skipped"


class StepRecord(Settings):
    """Result of the last run of a commissioning step, kept in the progress file."""

    outcome: StepOutcome
    at: str
    """Date and time, UTC, to the minute."""
    who: str
    measured: tuple[str, ...] = ()
    faults: tuple[StepFault, ...] = ()
    skipped: SkipCode | None = None

    @property
    def to_do(self) -> tuple[str, ...]:
        """Instruction for each fault, in words."""
        return tuple(each.text for each in self.faults)


class Progress(Settings):
    """State of a commissioning between sessions: findings and passed steps, stored as YAML."""

    name: str
    base: str
    """Settings that it began with."""
    bus: str
    findings: Findings = Findings()
    steps: Mapping[str, StepRecord] = Field(default={})
    """Records by step name."""

    def outcome_of(self, name: str) -> StepOutcome | None:
        """Return the outcome of a step's last run; None if it was not taken."""
        record = self.steps.get(name)
        return None if record is None else record.outcome

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
