"""A file of a recording: what a power cut leaves of it, and a disk that fails for a while."""

import errno
import random
import struct
from collections.abc import Iterator
from pathlib import Path

import pytest
import zstandard
from foxglove import Channel, Context
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import Chunk, Header
from mcap.stream_reader import StreamReader
from mcap.writer import MCAP0_MAGIC

from kurt2rt.runs.recording.recording_disk import RealDisk, WritableFile
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.recording.segment import KEPT_BYTES, Segment
from kurt2rt.runs.recording.segment_reader import SegmentReader
from tests.runs.replay.stored_runs import STORED


class FailingDisk(RealDisk):
    """A real disk of which calls fail, in turn, as `failures` says: None succeeds."""

    def __init__(self, failures: Iterator[OSError | None]) -> None:
        self.failures = failures

    def create(self, path: Path) -> WritableFile:
        return FailingFile(super().create(path), self.failures)


class FailingFile:
    def __init__(self, file: WritableFile, failures: Iterator[OSError | None]) -> None:
        self._file = file
        self._failures = failures

    def write_at(self, offset: int, data: bytes | bytearray) -> None:
        failure = next(self._failures, None)
        if failure is not None:
            self._file.write_at(offset, data[: len(data) // 2])  # a disk that is full takes a part
            raise failure
        self._file.write_at(offset, data)

    def sync(self) -> None:
        failure = next(self._failures, None)
        if failure is not None:
            raise failure
        self._file.sync()

    def close(self) -> None:
        self._file.close()


def said(path: Path) -> list[int]:
    return [int(message.data) for message in SegmentReader(path).messages()]


@pytest.mark.parametrize("every_bytes", [4000, pytest.param(1000, marks=pytest.mark.deep)])
def test_saved_chunks_survive_a_cut_at_any_byte(tmp_path: Path, every_bytes: int) -> None:
    context = Context()
    channel = Channel("/number", message_encoding="json", context=context)
    segment = Segment(tmp_path / "0001.mcap", context, RealDisk())
    segment.describe("run", {"task": "wall_following"})
    segment.attach("settings/x.yaml", b"a: 1\n", 5)
    saved: list[tuple[int, int]] = []
    for number in range(1, 2001):
        channel.log(b"%d" % number, log_time=number)
        if number % 25 == 0:
            segment.save()
            saved.append((segment.path.stat().st_size, number))
    segment.close()
    whole = segment.path.read_bytes()
    assert said(segment.path) == list(range(1, 2001))
    cut = tmp_path / "0002.mcap"
    for length in (*range(0, len(whole), every_bytes), len(whole) - 1):
        cut.write_bytes(whole[:length])
        reader = SegmentReader(cut)
        numbers = [int(message.data) for message in reader.messages()]
        assert numbers == list(range(1, len(numbers) + 1))
        assert len(numbers) >= max((number for size, number in saved if size <= length), default=0)
        assert str(cut) in reader.truncated


def test_segment_with_holes_is_read_up_to_the_first(tmp_path: Path) -> None:
    """A file may have its full length after a power cut, but zeros in place of its last data."""
    context = Context()
    channel = Channel("/number", message_encoding="json", context=context)
    segment = Segment(tmp_path / "0001.mcap", context, RealDisk())
    for number in range(1, 201):
        channel.log(b"%d" % number, log_time=number)
        if number == 100:
            segment.save()
            kept = segment.path.stat().st_size
    segment.close()
    whole = segment.path.read_bytes()
    for hole in range(kept, len(whole), 97):
        segment.path.write_bytes(whole[:hole] + bytes(len(whole) - hole))
        assert said(segment.path)[:100] == list(range(1, 101))


def test_a_call_that_fails_costs_nothing(tmp_path: Path) -> None:
    for failing in range(8):
        context = Context()
        channel = Channel("/number", message_encoding="json", context=context)
        failures = iter([*[None] * failing, OSError(errno.EIO, "as the test says")])
        segment = Segment(tmp_path / f"{failing + 1:04d}.mcap", context, FailingDisk(failures))
        failed = 0
        for number in range(1, 101):
            channel.log(b"%d" % number, log_time=number)
            if number % 20 == 0:
                try:
                    segment.save()
                except OSError:
                    failed += 1
        segment.close()
        assert failed == 1
        assert said(segment.path) == list(range(1, 101))


def test_a_disk_that_fails_for_long_is_given_up(tmp_path: Path) -> None:
    context = Context()
    channel = Channel("/noise", message_encoding="json", context=context)
    full = iter(lambda: OSError(errno.ENOSPC, "no space left on device"), None)
    segment = Segment(tmp_path / "0001.mcap", context, FailingDisk(full))
    chance = random.Random(1)
    while not segment.is_over_limit:
        channel.log(chance.randbytes(KEPT_BYTES // 10), log_time=1)
        with pytest.raises(OSError, match="no space"):
            segment.save()
    segment.give_up()
    assert segment.size_bytes < 2 * KEPT_BYTES


def with_chunk(path: Path, data: bytes, uncompressed_size: int, compression: str = "zstd") -> Path:
    """Write a file with one chunk whose header says `uncompressed_size`."""
    builder = RecordBuilder()
    Header(profile="", library="test").write(builder)
    Chunk(compression, data, 0, 0, 0, uncompressed_size).write(builder)
    path.write_bytes(MCAP0_MAGIC + bytes(builder.end()))  # type: ignore[no-untyped-call]
    return path


MANY = 100_000_000


@pytest.mark.parametrize("told", [MANY, 10], ids=["chunk tells its size", "only zstd's header does"])
def test_a_chunk_that_would_fill_the_memory_is_refused(tmp_path: Path, told: int) -> None:
    packed = zstandard.compress(bytes(MANY))
    path = with_chunk(tmp_path / "0001.mcap", packed, told)
    with pytest.raises(RecordingError, match=rf"0001\.mcap: .* {len(packed)} .* {MANY},"):
        SegmentReader(path).head()


def test_a_chunk_of_a_compression_without_limit_is_refused(tmp_path: Path) -> None:
    path = with_chunk(tmp_path / "0001.mcap", bytes(100), 100, "lz4")
    with pytest.raises(RecordingError, match=r"0001\.mcap: .*'lz4'.*zstd"):
        SegmentReader(path).head()


def test_records_of_a_stored_run_equal_those_of_mcaps_own_reader() -> None:
    path = STORED / "errand.mcap"
    with path.open("rb") as file:
        expected = list(StreamReader(file, validate_crcs=True).records)
    assert len(expected) > 4400
    assert list(SegmentReader(path).records()) == expected


@pytest.mark.parametrize("opcode", [Opcode.MESSAGE, Opcode.CHANNEL, Opcode.SCHEMA, 0x80])
@pytest.mark.parametrize("cut", [1, 8, 9, 40])
def test_chunk_with_a_record_cut_off_is_the_truncated_end(tmp_path: Path, opcode: int, cut: int) -> None:
    records = struct.pack("<BQ", opcode, 100) + bytes(100)
    reader = SegmentReader(with_chunk(tmp_path / "0001.mcap", records[:cut], cut, ""))
    assert [type(record) for record in reader.records()] == [Header]
    assert reader.truncated
