"""Recovery of a recording that a power cut truncated, to a file that viewers open."""

from pathlib import Path

import pytest
from mcap.reader import make_reader

from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.recording.recover import TRUNCATED_METADATA, recover_segment
from kurt2rt.runs.recording.run_folder import segments_in
from kurt2rt.runs.recording.segment_reader import SegmentReader
from tests.runs.recording.desk_recording import NAME, RecordedDesk


@pytest.fixture
def whole(tmp_path: Path) -> Path:
    desk = RecordedDesk(tmp_path)
    for second in range(4):
        desk.second(counts=200 + second)
    desk.recorder.close()
    (segment,) = segments_in(tmp_path / NAME)
    return segment


def test_recovery_copies_a_truncated_file_and_adds_its_index(whole: Path, tmp_path: Path) -> None:
    content = whole.read_bytes()
    truncated, copy = tmp_path / "torn.mcap", tmp_path / "copy.mcap"
    for share in (0.5, 0.7, 0.9, 1.0):
        truncated.write_bytes(content[: round(len(content) * share) - 1])
        because = recover_segment(truncated, copy)
        assert "index" in because
        assert list(SegmentReader(copy).messages()) == list(SegmentReader(truncated).messages())
        head = SegmentReader(truncated).head()
        assert SegmentReader(copy).head().attachments == head.attachments
        with copy.open("rb") as file:
            reader = make_reader(file, validate_crcs=True)
            summary = reader.get_summary()
            assert summary is not None
            assert summary.chunk_indexes
            noted = {each.name: each.metadata for each in reader.iter_metadata()}
        assert noted == {**head.metadata, TRUNCATED_METADATA: {"why": because}}
        copy.unlink()


def test_of_a_file_in_which_nothing_is_whole_no_copy_is_left(tmp_path: Path) -> None:
    truncated, copy = tmp_path / "torn.mcap", tmp_path / "copy.mcap"
    truncated.write_bytes(b"\x89MCAP")
    with pytest.raises(RecordingError, match=r"torn\.mcap"):
        recover_segment(truncated, copy)
    assert not copy.exists()


def test_a_copy_that_is_there_stays(whole: Path, tmp_path: Path) -> None:
    copy = tmp_path / "copy.mcap"
    copy.write_text("mine")
    with pytest.raises(RecordingError, match=r"copy\.mcap"):
        recover_segment(whole, copy)
    assert copy.read_text() == "mine"
