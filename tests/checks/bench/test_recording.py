"""Short measurement of a recorder's cost."""

from pathlib import Path

from kurt2rt.checks.bench.channel_load import LoadShifts
from kurt2rt.checks.bench.recording import drive_recorded, recording_results
from kurt2rt.checks.bench.robot_under_test import BenchFixture
from kurt2rt.runs.recording.run_folder import runs_in, segments_in
from kurt2rt.runs.recording.segment_reader import SegmentReader
from kurt2rt.runs.recording.topics import TICK


async def test_every_second_stretch_is_recorded(subject: BenchFixture, tmp_path: Path) -> None:
    drive = await drive_recorded(subject, tmp_path, LoadShifts(rounds=2, ticks=20), lambda _: None)
    (run,) = runs_in(tmp_path / "runs")
    (segment,) = segments_in(run)
    written = list(SegmentReader(segment).messages({TICK}))
    # More than 40 if the last ticks of a stretch were missed: the stall counts as a whole.
    assert len(written) + sum(each.missed_ticks for each in drive.recorded) >= 40
    assert len(written) <= 40
    assert (drive.trouble, drive.dropped) == ("", 0)
    assert drive.bytes_written > 0
    late, note, writing = recording_results(drive)
    assert [goal.what for goal in late.goals] == ["missed", "lost"]
    assert note.took.median_us > 0
    assert " MB " in writing.note
