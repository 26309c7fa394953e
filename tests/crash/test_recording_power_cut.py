"""The power goes at any moment while a run is recorded: all that the disk was said to have can be read."""

from pathlib import Path

import pytest

from kurt2rt.runs.recording.run_folder import Budget, segments_in
from kurt2rt.runs.recording.segment_reader import SegmentReader
from kurt2rt.runs.recording.tick_json import decode_tick
from kurt2rt.runs.recording.topics import TICK
from tests.crash.operations import Told
from tests.crash.power_cut import Disk, PowerCut, power_cuts
from tests.crash.traced_disk import TracedDisk
from tests.runs.recording.desk_recording import RecordedDesk

SMALL = Budget(10_000_000, segment_bytes=20_000, reserve_bytes=0)


def recorded(folder: Path, disk: TracedDisk, seconds: int) -> list[int]:
    """Record some seconds in small files; return the ticks."""
    desk = RecordedDesk(folder, disk=disk, budget=SMALL)
    for second in range(seconds):
        desk.second(counts=200 + second)
        disk.operations.append(Told(desk.recorder.written))
    desk.recorder.close()
    return [record.tick for record in desk.records]


def require_readable(cut: PowerCut, folder: Path, ticks: list[int]) -> None:
    cut.put(folder)
    read = [
        decode_tick(each.data).tick
        for segment in segments_in(folder)
        for each in SegmentReader(segment).messages({TICK})
    ]
    assert read == ticks[: len(read)]
    assert len(read) >= cut.told, {name: len(content) for name, content in cut.files.items()}


def cut_everywhere(folder: Path, disk: TracedDisk, seconds: int, every: int) -> int:
    """Check the recording after a power cut at each moment; return the number of states."""
    ticks = recorded(folder / "runs", disk, seconds)
    after = folder / "20261122T031005Z-after"
    after.mkdir()
    states = 0
    for number, cut in enumerate(power_cuts(Disk(), disk.operations, seed=1)):
        if number % every == 0:
            require_readable(cut, after, ticks)
            states += 1
    return states


@pytest.mark.parametrize("failing_syncs", [(), (2, 4)], ids=["sound", "two syncs fail"])
def test_recording_is_readable_up_to_its_last_sync(tmp_path: Path, failing_syncs: tuple[int, ...]) -> None:
    assert cut_everywhere(tmp_path, TracedDisk(failing_syncs), seconds=4, every=46) > 2


@pytest.mark.deep
@pytest.mark.parametrize("failing_syncs", [(), (1,), (2,), (3,), (4,), (5,), (2, 3, 4)], ids=str)
def test_it_is_so_in_every_power_cut(tmp_path: Path, failing_syncs: tuple[int, ...]) -> None:
    states = cut_everywhere(tmp_path, TracedDisk(failing_syncs), seconds=10, every=1)
    print(states, "states")
    assert states > 300
