"""Initial state of a run: its head, in the metadata of every segment, and what its recording begins with."""

import json
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from typing import Any

from hal.robot_settings import RobotSettings
from kurt2rt.runs.recording.recording_error import RecordingError
from simbridge.contracts.simulation import WorldView

RUN_VERSION = 1
"""Version of head, entries and attachments."""

RUN_METADATA, SEGMENT_METADATA = "run", "segment"
"""Metadata records with the head and with the number of the segment, in each segment."""


@dataclass(frozen=True, slots=True)
class RunHead:
    """First entry of a recording: versions, task and robot, and the state from which a replay begins."""

    kurt2rt: str
    """Version of the program."""
    boot: str
    """Identifier of this start of the program, hexadecimal."""
    started_at: str
    """Start in UTC, ISO 8601."""
    task: str
    robot: str
    """Name of the robot's settings."""
    bus: str
    """sim, or the robot's bus."""
    knowledge: str
    """Absolute path of the knowledge file; empty without one."""
    attended: bool
    """True if the robot drove in phases 1 to 4 only while a teacher was present."""
    asked: bool
    """True if the robot could ask a teacher."""
    stopped: str
    """Code of the initial stop (kurt2rt.core.decision.standing.StopReason); empty without one."""
    behaviour: str
    """Active taught behaviour at the start."""
    fingerprints: dict[str, str]
    """SHA-256 of each attachment by name."""
    version: int = RUN_VERSION
    tolerates_stalls: bool = False
    """True if missed ticks were not counted against the teacher's leases."""
    plugins: dict[str, str] = field(default_factory=dict)
    """Source of each plug-in that the program had loaded, by kind and name."""


def encode_head(head: RunHead) -> dict[str, str]:
    """Return the head as MCAP metadata: texts by name."""
    content = asdict(head)
    return {key: value if isinstance(value, str) else json.dumps(value) for key, value in content.items()}


def decode_head(metadata: dict[str, str]) -> RunHead:
    """Decode the metadata of `encode_head`. Raises RecordingError, also for a run of another version."""
    try:
        version = json.loads(metadata["version"])
        if version != RUN_VERSION:
            raise RecordingError(
                f"the recording has version {version}, this kurt2rt reads version {RUN_VERSION}",
                do=f"replay it with the kurt2rt that recorded it ({metadata.get('kurt2rt')})",
            )
        content: dict[str, Any] = {}
        for each in fields(RunHead):
            text = metadata[each.name]
            content[each.name] = text if each.type is str else json.loads(text)
        return RunHead(**content)
    except (KeyError, ValueError, TypeError, RecursionError) as error:
        raise RecordingError(f"the head of the run cannot be read: {type(error).__name__}: {error}") from error


@dataclass(frozen=True, slots=True)
class RecordedRun:
    """All that is known of a run at its start, which each of its segment files gets."""

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
