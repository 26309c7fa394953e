"""Check of the recording that a killed robot program leaves."""

from dataclasses import dataclass
from pathlib import Path

from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.recording.run_folder import runs_in, segments_in
from kurt2rt.runs.replay.comparison import compare
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.runs.replay.replay import Replay
from kurt2rt.runs.replay.run import Run


@dataclass(frozen=True, slots=True)
class KilledRecording:
    """A recording that ended with its program."""

    ticks: int = 0
    """That can be read."""
    until_s: float = 0.0
    """Time of the last readable tick, by the runtime's clock."""
    refused: str = ""
    """Why nothing can be read, in a sentence: it was killed before the first second was on the disk."""


class KilledRecordings:
    """The recordings of one program after the other."""

    def __init__(self, recordings: Path) -> None:
        self._recordings = recordings
        self._seen: set[Path] = set()

    def newest(self, *, replayed: bool) -> KilledRecording | None:
        """Read what came since the last time; None where there is none. `replayed`: every tick comes out the same."""
        new = [run for run in runs_in(self._recordings) if run not in self._seen]
        self._seen.update(new)
        assert len(new) <= 1
        if not new or not segments_in(new[0]):
            return None
        try:
            run = read_run(new[0])
        except RecordingError as error:
            refused = str(error)
        else:
            return _read(run, replayed=replayed)
        assert str(new[0]) in refused
        return KilledRecording(refused=refused)


def _read(run: Run, *, replayed: bool) -> KilledRecording:
    ticks, until_s = 0, 0.0
    for entry in run.entries():
        ticks += 1
        until_s = entry.now_s
    assert run.has_no_gap, run.trouble
    assert run.trouble, "a run that was killed ended as it should"
    if replayed:
        for entry, record in Replay(run):
            assert compare(entry, record) == []
    return KilledRecording(ticks, until_s)
