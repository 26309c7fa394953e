"""Recording in its own thread: every tick is readable afterwards, and a bad disk delays no tick."""

import errno
import json
import shutil
import threading
from pathlib import Path

from mcap.reader import make_reader

from kurt2rt.core.rla.rla_system import knowledge_hash_of
from kurt2rt.core.teaching.commands import Teach
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.exchange.attachments import ROBOT, TASK
from kurt2rt.knowledge.journal.writer import Acknowledgement
from kurt2rt.runs.recording.entries import TickEntry, tick_entry
from kurt2rt.runs.recording.recording_disk import RealDisk, WritableFile
from kurt2rt.runs.recording.run_folder import Budget, runs_in, segments_in
from kurt2rt.runs.recording.run_head import RUN_METADATA, decode_head
from kurt2rt.runs.recording.segment_reader import LoggedMessage, SegmentReader
from kurt2rt.runs.recording.tick_json import decode_tick
from kurt2rt.runs.recording.topics import LESSON, LOG, POSE, SCAN, SCENE, SITUATION, TF, TICK
from tests.runs.recording.desk_recording import ATTACHMENTS, BEGAN_AT_NS, HEAD, NAME, RecordedDesk
from tests.runs.recording.test_segment import FailingDisk


def messages_of(run: Path, *topics: str) -> list[LoggedMessage]:
    return [each for segment in segments_in(run) for each in SegmentReader(segment).messages(topics or None)]


def entries_of(run: Path) -> list[TickEntry]:
    return [decode_tick(each.data) for each in messages_of(run, TICK)]


def entry_of(record: TickRecord) -> TickEntry:
    known = record.knowledge
    hashed = None if known is None else knowledge_hash_of(sorted(known, key=lambda rla: rla.rla_id))
    return tick_entry(record, saved=False, knowledge=hashed)


def test_every_tick_is_there_again_to_the_last_bit(tmp_path: Path) -> None:
    desk = RecordedDesk(tmp_path)
    desk.second(counts=200)
    desk.desk.runtime.inbox.put(Teach("t-1", "Ann", "forward"))
    desk.second(counts=203)
    desk.recorder.close()
    assert desk.recorder.trouble == ""
    assert desk.recorder.written == 200
    assert entries_of(tmp_path / NAME) == [entry_of(record) for record in desk.records]
    lessons = [json.loads(each.data) for each in messages_of(tmp_path / NAME, LESSON)]
    assert [each["event"]["command_id"] for each in lessons] == ["t-1"]


def test_recording_has_foxglove_scans_poses_scenes_and_log(tmp_path: Path) -> None:
    desk = RecordedDesk(tmp_path)
    desk.second(counts=200)
    desk.recorder.on_question("I know nothing yet, teach me")
    desk.recorder.on_acknowledged(Acknowledgement("t-1", 1, None, "2026-11-22T03:10:05.000+00:00"))
    desk.recorder.close()
    said = messages_of(tmp_path / NAME)
    times = {topic: sum(each.topic == topic for each in said) for topic in (SCAN, POSE, TF, SCENE, SITUATION)}
    assert times == {SCAN: 20, POSE: 20, TF: 20, SCENE: 10, SITUATION: 10}
    schemas = {each.topic: each.schema for each in said}
    assert schemas[SCAN] == "foxglove.LaserScan"
    assert schemas[POSE] == "foxglove.PoseInFrame"
    assert schemas[TF] == "foxglove.FrameTransforms"
    assert schemas[SCENE] == "foxglove.SceneUpdate"
    assert schemas[LOG] == "foxglove.Log"
    assert b"I know nothing yet, teach me" in b"".join(each.data for each in said if each.topic == LOG)
    first = desk.records[0]
    assert said[0].time_ns == BEGAN_AT_NS + round(first.now_s * 1e9)


def test_run_goes_on_in_a_next_segment_that_opens_alone(tmp_path: Path) -> None:
    desk = RecordedDesk(tmp_path, budget=Budget(10_000_000, segment_bytes=20_000))
    for second in range(8):
        desk.second(counts=200 + second)
    desk.recorder.close()
    segments = segments_in(tmp_path / NAME)
    assert len(segments) > 2
    for segment in segments:
        with segment.open("rb") as file:
            summary = make_reader(file, validate_crcs=True).get_summary()
        assert summary is not None
        assert summary.chunk_indexes
        assert {channel.topic for channel in summary.channels.values()} >= {TICK, SCAN, SCENE}
        assert decode_head(SegmentReader(segment).head().metadata[RUN_METADATA]) == HEAD
    settings = {name: ATTACHMENTS[name] for name in (ROBOT, TASK)}  # with which a later one can be understood alone
    assert SegmentReader(segments[1]).head().attachments == settings
    assert [each.tick for each in entries_of(tmp_path / NAME)] == [record.tick for record in desk.records]


def test_older_runs_make_room_then_the_oldest_files_of_this_one(tmp_path: Path) -> None:
    older = RecordedDesk(tmp_path, name="20251231T235959Z-wall_following")
    older.second()
    older.recorder.close()
    desk = RecordedDesk(tmp_path, budget=Budget(75_000, segment_bytes=20_000))
    for second in range(15):
        desk.second(counts=200 + second)
    desk.recorder.close()
    (run,) = runs_in(tmp_path)
    assert run.name == NAME
    segments = segments_in(run)
    assert sum(segment.stat().st_size for segment in segments) <= 100_000
    assert segments[0].name != "0001.mcap"
    assert entries_of(run)[-1].tick == desk.records[-1].tick


def test_a_run_that_another_program_records_is_left_alone(tmp_path: Path) -> None:
    other = RecordedDesk(tmp_path, name="20251231T235959Z-wall_following")
    other.second()
    desk = RecordedDesk(tmp_path, budget=Budget(20_000, segment_bytes=10_000))
    desk.second()
    other.second()
    desk.recorder.close()
    other.recorder.close()
    assert len(entries_of(tmp_path / "20251231T235959Z-wall_following")) == 200


def test_a_disk_that_fails_once_costs_nothing(tmp_path: Path) -> None:
    for failing in range(6):
        failures = iter([*[None] * failing, OSError(errno.EIO, "input/output error")])
        desk = RecordedDesk(tmp_path / str(failing), disk=FailingDisk(failures), polled=False)
        for _ in range(3):
            desk.second()
        desk.recorder.close()
        assert list(failures) == []  # it did fail
        assert desk.recorder.trouble == ""
        assert [each.tick for each in entries_of(tmp_path / str(failing) / NAME)] == [
            each.tick for each in desk.records
        ]


class AbsentDisk(RealDisk):
    """A disk that is not there yet."""

    def __init__(self) -> None:
        self.there = False

    def make_folder(self, path: Path) -> None:
        if not self.there:
            raise OSError(errno.ENOENT, "absent")
        super().make_folder(path)


def test_a_disk_that_comes_later_gets_what_waited_for_it(tmp_path: Path) -> None:
    disk = AbsentDisk()
    desk = RecordedDesk(tmp_path, disk=disk)
    desk.second()
    assert "absent" in desk.recorder.trouble
    disk.there = True
    desk.second()
    desk.second()
    desk.recorder.close()
    assert desk.recorder.trouble == ""
    assert len(entries_of(tmp_path / NAME)) == 300


def test_recorder_overrun_is_counted_and_shows_as_a_gap(tmp_path: Path) -> None:
    disk = AbsentDisk()
    desk = RecordedDesk(tmp_path, disk=disk, capacity=150)
    desk.second()
    desk.second()
    assert desk.recorder.dropped == 50
    disk.there = True
    desk.recorder.poll()
    desk.recorder.write_waiting()
    desk.second()
    desk.recorder.close()
    assert "50 of" in desk.recorder.trouble
    ticks = [each.tick for each in entries_of(tmp_path / NAME)]
    assert ticks == [each.tick for each in desk.records[:150]] + [each.tick for each in desk.records[200:]]


class FullDisk(RealDisk):
    """A disk with so much room."""

    def __init__(self, free: int) -> None:
        self.free = free

    def free_bytes(self, path: Path) -> int:  # noqa: ARG002 - it has this one disk
        return self.free


def test_the_last_room_on_the_disk_is_left_for_lessons(tmp_path: Path) -> None:
    disk = FullDisk(1_000_000_000)
    desk = RecordedDesk(tmp_path, disk=disk)
    desk.second()
    assert desk.recorder.trouble == ""
    disk.free = 100_000_000
    desk.recorder.poll()
    desk.second()
    assert "100 MB" in desk.recorder.trouble
    disk.free = 1_000_000_000
    desk.second()
    desk.second()
    desk.recorder.close()
    assert desk.recorder.trouble == ""
    assert len(entries_of(tmp_path / NAME)) == len(desk.records)


class HangingDisk(RealDisk):
    """A disk that does not answer, until it is set free."""

    def __init__(self) -> None:
        self.hangs = threading.Event()
        self.free = threading.Event()

    def create(self, path: Path) -> WritableFile:
        self.hangs.set()
        self.free.wait()
        return super().create(path)


def test_the_loop_goes_on_while_the_disk_hangs(tmp_path: Path) -> None:
    disk = HangingDisk()
    desk = RecordedDesk(tmp_path, disk=disk, capacity=120, polled=False)
    desk.recorder.start()
    desk.run(1)
    assert disk.hangs.wait(10.0)
    desk.run(129)
    assert desk.recorder.dropped == 10
    desk.recorder.close(patience_s=0.01)
    assert desk.recorder.dropped == 130
    assert "130 of" in desk.recorder.trouble
    disk.free.set()


def test_a_run_that_is_deleted_while_it_is_recorded_begins_anew(tmp_path: Path) -> None:
    desk = RecordedDesk(tmp_path / "runs")
    desk.second()
    shutil.rmtree(tmp_path / "runs")
    desk.second()
    desk.second()
    desk.recorder.close()
    assert [each.tick for each in entries_of(tmp_path / "runs" / NAME)] == [each.tick for each in desk.records[200:]]
    (segment,) = segments_in(tmp_path / "runs" / NAME)
    assert SegmentReader(segment).head().attachments == ATTACHMENTS
    assert desk.recorder.dropped == 200


def test_recorder_without_room_leaves_no_folder(tmp_path: Path) -> None:
    empty = tmp_path / "runs" / "20251231T235959Z-wall_following"
    empty.mkdir(parents=True)
    desk = RecordedDesk(tmp_path / "runs", disk=FullDisk(100))
    desk.second()
    desk.recorder.close()
    assert " 0 MB" in desk.recorder.trouble
    assert desk.recorder.dropped == 100
    assert runs_in(tmp_path / "runs") == []


class WithoutNames(RealDisk):
    """A disk that cannot keep the names of new files."""

    def create(self, path: Path) -> WritableFile:
        super().create(path).close()
        raise OSError(errno.EIO, f"input/output error: {path.name}")


def test_a_run_of_which_no_file_could_be_made_leaves_no_folder(tmp_path: Path) -> None:
    desk = RecordedDesk(tmp_path, disk=WithoutNames())
    desk.second()
    desk.recorder.close()
    assert "input/output error" in desk.recorder.trouble
    assert desk.recorder.run is None
    assert runs_in(tmp_path) == []


def test_the_end_that_the_disk_does_not_take_is_counted(tmp_path: Path) -> None:
    failures = iter([None, None, *[OSError(errno.ENOSPC, "no space left on device")] * 9])
    desk = RecordedDesk(tmp_path, disk=FailingDisk(failures))
    desk.second()
    desk.recorder.close()
    assert (desk.recorder.written, desk.recorder.dropped) == (0, 100)
    assert "no space left" in desk.recorder.trouble
    assert desk.recorder.dropped == 100


class Unsayable:
    """A question that cannot be said."""

    def __str__(self) -> str:
        raise ZeroDivisionError("unsayable")


def test_recorder_counts_an_unwritable_note_and_keeps_the_others(tmp_path: Path) -> None:
    desk = RecordedDesk(tmp_path, polled=False)
    with desk.recorder:
        desk.run(50)
        desk.recorder.on_question(Unsayable())
        desk.run(50)
    assert len(entries_of(tmp_path / NAME)) == 100
    assert (desk.recorder.written, desk.recorder.dropped) == (100, 1)
    assert "ZeroDivisionError('unsayable')" in desk.recorder.trouble
