"""Head of a run: its circumstances, in the metadata of every segment."""

import json
from dataclasses import asdict, dataclass, field, fields
from typing import Any

from hal.sensor_signs import SensorRules
from kurt2rt.runs.recording.recording_error import RecordingError

RUN_VERSION = 4
"""Version of head, entries and attachments; raise it if an older program would misread them.

2: a robot that touches something asks.
3: a robot with a broken sensor stops.
4: the motion of the wheels tells a sensor that sees a phantom.
"""

_BEFORE: dict[str, Any] = {
    "tolerates_stalls": False,
    "asks_when_held": False,
    "checks_sensors": False,
    "sensor_rules": SensorRules.NOISE,
    "plugins": {},
}
"""Values of later fields that hold for older recordings."""

RUN_METADATA = "run"
"""Metadata record with the head, in each segment."""


@dataclass(frozen=True, slots=True)
class RunHead:
    """Circumstances of one run."""

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
    """Absolute path of the knowledge file; empty without one.

    Up to 2026-11-22 the path is relative to the working folder of the program.
    """
    attended: bool
    """True if the robot drove in phases 1 to 4 only while a teacher was present."""
    asked: bool
    """True if the robot could ask a teacher."""
    stopped: str
    """Reason of the initial stop; empty without one."""
    behaviour: str
    """Active taught behaviour at the start."""
    fingerprints: dict[str, str]
    """SHA-256 of each attachment by name."""
    version: int = RUN_VERSION
    tolerates_stalls: bool = False
    """True if missed ticks were not counted against the teacher's leases."""
    asks_when_held: bool = True
    """True if the robot asked when a bumper blocked its action."""
    checks_sensors: bool = True
    """True if the robot noticed single broken sensors."""
    sensor_rules: int = SensorRules.MOTION
    """Rules by which it noticed them (hal.sensor_watch.SensorRules)."""
    plugins: dict[str, str] = field(default_factory=dict)
    """Source of each plug-in that the program had loaded, by kind and name."""


def encode_head(head: RunHead) -> dict[str, str]:
    """Return the head as MCAP metadata: texts by name."""
    content = asdict(head)
    return {key: value if isinstance(value, str) else json.dumps(value) for key, value in content.items()}


def decode_head(metadata: dict[str, str]) -> RunHead:
    """Decode the metadata of `encode_head`. Raises RecordingError, also for a run of a newer program."""
    try:
        version = json.loads(metadata["version"])
        if version > RUN_VERSION:
            raise RecordingError(
                f"the run was recorded by a newer kurt2rt ({metadata.get('kurt2rt')})", do="replay it with that one"
            )
        content: dict[str, Any] = {}
        for each in fields(RunHead):
            if each.name in _BEFORE and each.name not in metadata:
                content[each.name] = _BEFORE[each.name]
                continue
            text = metadata[each.name]
            content[each.name] = text if each.type is str else json.loads(text)
        return RunHead(**content)
    except (KeyError, ValueError, TypeError, RecursionError) as error:
        raise RecordingError(f"the head of the run cannot be read: {type(error).__name__}: {error}") from error
