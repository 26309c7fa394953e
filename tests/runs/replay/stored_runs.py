"""The stored runs, which tests.runs.replay.stories made: a robot that was taught, recorded tick by tick."""

import math
from functools import cache
from itertools import islice
from pathlib import Path

from kurt2rt.runs.recording.entries import TickEntry
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.runs.replay.replay import Replay, ReplayedTick
from kurt2rt.runs.replay.run import Run, RunSource
from kurt2rt.runtime import Runtime

STORED = Path(__file__).parent / "runs"
NAMES = ("walls", "errand")


def stored(name: str, seconds: float = math.inf) -> Run:
    """Return a stored run, or its first `seconds`; the file is decoded once."""
    whole = read_run(STORED / f"{name}.mcap")
    if math.isinf(seconds):
        return Run(whole.name, whole.head, whole._attachments, RunSource(lambda: iter(_entries(name))))
    ticks = round(seconds * 100)
    return Run(
        f"the beginning of {name}", whole.head, whole._attachments, RunSource(lambda: islice(_entries(name), ticks))
    )


@cache
def _entries(name: str) -> tuple[TickEntry, ...]:
    return tuple(read_run(STORED / f"{name}.mcap").entries())


def replay_until(run: Run, now_s: float) -> tuple[Runtime, ReplayedTick]:
    """Return the runtime after the last tick that began by `now_s` of its clock, or after the first, and that tick."""
    replay = Replay(run)
    entries = run.entries()
    last = next(entries)
    record = replay.step(last)
    for entry in entries:
        if entry.now_s > now_s:
            break
        last, record = entry, replay.step(entry)
    return replay.runtime, ReplayedTick(last, record)
