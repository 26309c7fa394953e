"""What a run is, for the one who reads its recording: it stands in every segment's metadata."""

import json
from dataclasses import asdict, dataclass, fields
from typing import Any

from kurt2rt.runs.recording.recording_error import RecordingError

RUN_VERSION = 2
"""Raise it when head, entries or attachments change so that an older program would misread them.

2: a robot that touches something asks.
"""

_BEFORE: dict[str, Any] = {"tolerates_stalls": False, "asks_when_held": False}
"""Fields added by later versions, with the values that hold for older recordings."""

RUN_METADATA = "run"
"""Name of the metadata record that holds the head, in each segment."""


@dataclass(frozen=True, slots=True)
class RunHead:
    """The circumstances of one run."""

    kurt2rt: str
    """Version of the program."""
    boot: str
    """Names this start of the program, hexadecimal."""
    started_at: str
    """UTC, ISO 8601."""
    task: str
    robot: str
    """Name of the robot's settings."""
    bus: str
    """sim, or the bus that the robot was on."""
    knowledge: str
    """File that it taught into, from the root on; empty where there was none. Up to 2026-11-22 it was kept as it was
    given: from the folder that the program was started in."""
    attended: bool
    """Whether in phases 1 to 4 the robot drove by its RLAs only while a teacher was there."""
    asked: bool
    """Whether somebody was there who could be asked."""
    stopped: str
    """Why the robot stood at the start until it was told to resume; empty where it did not."""
    behaviour: str
    """The taught behaviour that was wanted at the start."""
    fingerprints: dict[str, str]
    """SHA-256 of each attachment, by its name."""
    version: int = RUN_VERSION
    tolerates_stalls: bool = False
    """Whether ticks that were missed counted against no lease of the teacher."""
    asks_when_held: bool = True
    """Whether the robot asked when it touched something and was to drive on toward it."""


def encode_head(head: RunHead) -> dict[str, str]:
    """As the metadata of an MCAP file: texts by names."""
    content = asdict(head)
    return {key: value if isinstance(value, str) else json.dumps(value) for key, value in content.items()}


def decode_head(metadata: dict[str, str]) -> RunHead:
    """The head that `encode_head` wrote. Raises RecordingError, also for a run of a newer program."""
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
