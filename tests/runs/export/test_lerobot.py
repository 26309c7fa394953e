"""Data sets for LeRobot, held to the rules of LeRobotDataset v3.0, which lerobot 0.4.4 reads."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from kurt2rt.runs.export.episodes import features_of, read_episodes
from kurt2rt.runs.export.lerobot import DatasetWriter, export_lerobot
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.replay.run import Run, RunSource
from tests.runs.replay.stored_runs import stored

OF_EVERY_DATA_SET = {
    "timestamp": "float32",
    "frame_index": "int64",
    "episode_index": "int64",
    "index": "int64",
    "task_index": "int64",
}
"""LeRobot's DEFAULT_FEATURES."""
STATISTICS = ("min", "max", "mean", "std", "count", "q01", "q10", "q50", "q90", "q99")


@pytest.fixture(scope="module")
def data_set(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a data set of two stored runs at 20 frames a second."""
    folder = tmp_path_factory.mktemp("exported") / "set"
    export_lerobot([stored("walls"), stored("errand")], folder, 20)
    return folder


def read_json(path: Path) -> dict[str, Any]:
    content: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return content


def frames_of(folder: Path) -> pa.Table:
    return pa.concat_tables(pq.read_table(each) for each in sorted(folder.glob("data/*/*.parquet")))


def episodes_of(folder: Path) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = pq.read_table(folder / "meta/episodes/chunk-000/file-000.parquet").to_pylist()
    return rows


def test_info_describes_every_column_of_the_files(data_set: Path) -> None:
    info = read_json(data_set / "meta/info.json")
    assert (info["codebase_version"], info["robot_type"], info["fps"]) == ("v3.0", "kurt2-indoor", 20)
    assert (info["total_episodes"], info["total_frames"], info["total_tasks"]) == (2, 1760, 3)
    assert (info["splits"], info["video_path"]) == ({"train": "0:2"}, None)
    kinds = {name: each["dtype"] for name, each in info["features"].items()}
    assert OF_EVERY_DATA_SET.items() <= kinds.items()
    schema = pq.read_schema(data_set / info["data_path"].format(chunk_index=0, file_index=0))
    assert schema.names == list(kinds)
    for name, each in info["features"].items():
        assert "/" not in name
        (length,) = each["shape"]
        value = pa.from_numpy_dtype(np.dtype(each["dtype"]))
        assert schema.field(name).type == (value if each["names"] is None else pa.list_(value, length))
        assert each["names"] is None or len(set(each["names"])) == length


def test_frames_count_up_and_name_their_task(data_set: Path) -> None:
    frames = frames_of(data_set)
    tasks = pq.read_table(data_set / "meta/tasks.parquet").to_pydict()
    (at,) = set(tasks) - {"task_index"}
    assert dict(zip(tasks[at], tasks["task_index"], strict=True)) == {
        "wall following": 0,
        "errands: straight on": 1,
        "errands: turn right": 2,
    }
    assert frames["index"].to_pylist() == list(range(1760))
    assert frames["episode_index"].to_pylist() == [0] * 880 + [1] * 880
    assert frames["frame_index"].to_pylist() == [*range(880), *range(880)]
    assert frames["timestamp"].to_numpy()[:880] == pytest.approx(np.arange(880) / 20, abs=1e-4)
    assert set(frames["task_index"].to_pylist()[880:]) == {1, 2}


def test_tasks_are_the_index_of_a_table_of_pandas(data_set: Path) -> None:
    about = json.loads(pq.read_schema(data_set / "meta/tasks.parquet").metadata[b"pandas"])
    names = [each["field_name"] for each in about["columns"]]
    assert about["index_columns"] == [names[1]]
    assert pq.read_schema(data_set / "meta/tasks.parquet").names == names


def test_episodes_say_where_their_frames_are(data_set: Path) -> None:
    for number, row in enumerate(episodes_of(data_set)):
        assert (row["episode_index"], row["length"]) == (number, 880)
        assert (row["dataset_from_index"], row["dataset_to_index"]) == (880 * number, 880 * (number + 1))
        assert (row["data/chunk_index"], row["data/file_index"]) == (0, 0)
        assert (row["meta/episodes/chunk_index"], row["meta/episodes/file_index"]) == (0, 0)
    assert [row["tasks"] for row in episodes_of(data_set)] == [
        ["wall following"],
        ["errands: straight on", "errands: turn right"],
    ]


def test_statistics_are_those_of_the_frames(data_set: Path) -> None:
    info, stats = read_json(data_set / "meta/info.json"), read_json(data_set / "meta/stats.json")
    frames = frames_of(data_set)
    assert stats.keys() == info["features"].keys()
    for name, each in info["features"].items():
        values = np.array(frames[name].to_pylist(), dtype=np.float64).reshape(1760, -1)
        assert {key: len(value) for key, value in stats[name].items()} == {
            key: 1 if key == "count" else each["shape"][0] for key in STATISTICS
        }
        assert stats[name]["count"] == [1760]
        assert stats[name]["mean"] == pytest.approx(values.mean(axis=0))
        assert stats[name]["std"] == pytest.approx(values.std(axis=0))
        assert stats[name]["max"] == pytest.approx(values.max(axis=0))
        for row in episodes_of(data_set):
            mine = values[row["dataset_from_index"] : row["dataset_to_index"]]
            assert row[f"stats/{name}/q50"] == pytest.approx(np.median(mine, axis=0))
            assert row[f"stats/{name}/min"] == pytest.approx(mine.min(axis=0))


def test_full_file_is_followed_by_the_next(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kurt2rt.runs.export.lerobot.FILES_PER_CHUNK", 2)
    run = stored("walls", 5.0)
    (episode,) = read_episodes(run, 1)
    with DatasetWriter(tmp_path, features_of(run.robot), 100, "kurt2", file_mb=0) as writer:
        for _ in range(3):
            writer.add(episode, {})
    files = sorted(str(each.relative_to(tmp_path)) for each in tmp_path.glob("data/*/*"))
    assert files == [f"data/chunk-00{chunk}/file-00{file}.parquet" for chunk, file in ((0, 0), (0, 1), (1, 0))]
    for row in episodes_of(tmp_path):
        path = f"data/chunk-{row['data/chunk_index']:03d}/file-{row['data/file_index']:03d}.parquet"
        assert set(pq.read_table(tmp_path / path)["episode_index"].to_pylist()) == {row["episode_index"]}
    assert frames_of(tmp_path)["index"].to_pylist() == list(range(1500))


def test_data_set_can_be_read_by_other_users(data_set: Path) -> None:
    assert data_set.stat().st_mode & 0o777 == 0o755


def test_source_of_each_episode_is_noted(data_set: Path) -> None:
    first, second = read_json(data_set / "meta/kurt2rt.json")["episodes"]
    assert (first["episode_index"], first["run"], first["task"]) == (0, "walls.mcap", "wall_following")
    assert (second["episode_index"], second["run"], second["first_tick"]) == (1, "errand.mcap", 1)


def test_runs_of_different_robots_are_refused(tmp_path: Path) -> None:
    other = stored("errand", 1.0)
    other.robot = other.robot.model_copy(update={"name": "other"})
    with pytest.raises(RecordingError, match="export runs of one robot at a time"):
        export_lerobot([stored("walls", 1.0), other], tmp_path / "set", 100)
    assert not list(tmp_path.iterdir())


def test_run_without_ticks_leaves_no_folder(tmp_path: Path) -> None:
    whole = stored("walls")
    empty = Run("empty", whole.head, whole._attachments, RunSource(lambda: iter(())), partial=True)
    with pytest.raises(RecordingError, match="empty: has no ticks"):
        export_lerobot([empty], tmp_path / "set", 100)
    assert not list(tmp_path.iterdir())


def test_export_that_fails_leaves_what_was_there(tmp_path: Path) -> None:
    (tmp_path / "set").mkdir()
    (tmp_path / "set" / "mine").touch()
    with pytest.raises(RecordingError, match="something is there already"):
        export_lerobot([stored("walls", 1.0)], tmp_path / "set", 100)
    assert [each.name for each in (tmp_path / "set").iterdir()] == ["mine"]
