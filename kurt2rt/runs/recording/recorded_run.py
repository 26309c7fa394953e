"""Initial state of a run that its recording begins with."""

import time
from collections.abc import Mapping
from dataclasses import dataclass

from hal.robot_settings import RobotSettings
from kurt2rt.runs.recording.run_head import RUN_METADATA, RunHead, encode_head
from simbridge.contracts.simulation import WorldView

SEGMENT_METADATA = "segment"
"""Metadata record with the segment's number, next to the head of the run."""


@dataclass(frozen=True, slots=True)
class RecordedRun:
    """Properties of one run that are fixed at its start."""

    name: str
    """Name of the run's folder."""
    head: RunHead
    attachments: Mapping[str, bytes]
    """Attachments of the first segment by name."""
    settings: RobotSettings
    features: tuple[str, ...]
    """Names of the situation's values."""
    world: WorldView | None = None
    """World of a simulated robot."""
    began_at_ns: int | None = None
    """Time since 1970 of the runtime clock's 0 for simulated time; None: measured at the first tick."""

    def metadata(self, segment: int) -> dict[str, dict[str, str]]:
        """Return the metadata records of the n-th segment."""
        return {RUN_METADATA: encode_head(self.head), SEGMENT_METADATA: {"number": str(segment), "run": self.name}}

    def now_ns(self) -> int:
        """Return the time since 1970; for simulated time its beginning."""
        return time.time_ns() if self.began_at_ns is None else self.began_at_ns
