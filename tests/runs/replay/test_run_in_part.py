"""A run of which not all is there any more: it is not replayed, but what there is can be looked at."""

from pathlib import Path

import pytest

from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.recording.run_folder import segments_in
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.runs.replay.replay import Replay
from kurt2rt.runs.replay.verify import verify
from tests.runs.recording.desk_recording import empty_run, late_run


@pytest.fixture(scope="module")
def late(tmp_path_factory: pytest.TempPathFactory) -> Path:
    run = late_run(tmp_path_factory.mktemp("runs"))
    assert segments_in(run)[0].name != "0001.mcap"
    return run


def test_run_without_its_beginning_is_refused_with_first_tick(late: Path) -> None:
    first = next(read_run(late, partial=True).partial_entries()).number
    with pytest.raises(RecordingError, match=rf" tick {first} .* recordings_mb"):
        read_run(late)
    with pytest.raises(RecordingError, match=rf" tick {first} "):
        Replay(read_run(late, partial=True))


def test_of_a_run_without_a_tick_nothing_is_the_same(tmp_path: Path) -> None:
    run = empty_run(tmp_path)
    with pytest.raises(RecordingError, match="no tick"):
        verify(read_run(run))
