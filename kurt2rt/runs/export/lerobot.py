"""Writer of recorded runs as a data set for LeRobot (LeRobotDataset, format v3.0)."""

import json
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from kurt2rt.runs.export.episodes import Column, Episode, Feature, features_of, read_episodes, ticks_per_frame
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.replay.run import Report, Run, progress_reporter

FORMAT = "v3.0"
FILE_MB, FILES_PER_CHUNK = 100, 1000
"""LeRobot's own limits of a data file, which holds whole episodes, and of a folder."""
_FILE = "chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
_COUNTED = {
    "timestamp": Feature("float32"),
    "frame_index": Feature("int64"),
    "episode_index": Feature("int64"),
    "index": Feature("int64"),
    "task_index": Feature("int64"),
}
"""Features that every data set has."""


Statistics = dict[str, dict[str, Column]]
"""Statistics by feature and name, each (length,); count (1,)."""
_QUANTILES = (0.01, 0.1, 0.5, 0.9, 0.99)


@dataclass(slots=True)
class ExportedRun:
    """Result of one run's export to a data set: its numbers of episodes and frames."""

    run: str
    episodes: int = 0
    frames: int = 0
    trouble: str = ""
    """Ticks that are missing in the recording, in a sentence; empty if none are."""


def export_lerobot(
    runs: Sequence[Run],
    folder: Path,
    fps: int,
    report: Report = lambda *_: None,
) -> list[ExportedRun]:
    """Write a data set into a new folder, which appears when it is complete, and return what each run gave.

    Args:
        runs: of one robot, opened with `partial` if their beginning may be missing.
        folder: nothing may be there yet, or an empty folder.
        fps: frames a second.
        report: called now and then with a run's name, its seconds that were read, and its length.

    Raises:
        RecordingError: a run cannot be read or is of another robot, or `fps` does not fit the ticks.
        OSError: the folder cannot be written.
    """
    features = features_of(runs[0].robot)
    for run in runs[1:]:
        if (run.robot.name, features_of(run.robot)) != (runs[0].robot.name, features):
            raise RecordingError(
                f"is of robot {run.robot.name}, and {runs[0].name} of {runs[0].robot.name}, with other features",
                where=run.name,
                do="export runs of one robot at a time",
            )
    exported = []
    with _new_folder(folder) as new, DatasetWriter(new, features, fps, runs[0].robot.name) as writer:
        for run in runs:
            done = ExportedRun(run.name)
            for episode in read_episodes(run, ticks_per_frame(run.robot, fps), progress_reporter(run, report)):
                writer.add(episode, _source_of(run, episode))
                done.episodes += 1
                done.frames += episode.frames
            done.trouble = run.trouble
            exported.append(done)
        if not writer.episodes:
            raise RecordingError("has no ticks", where=runs[0].name, do="give a run in which the robot was on")
    return exported


class DatasetWriter:
    """Writer of the files of a data set. `meta/info.json` is written last, at the end of the context."""

    def __init__(
        self, folder: Path, features: dict[str, Feature], fps: int, robot: str, file_mb: int = FILE_MB
    ) -> None:
        self._folder, self._fps, self._robot, self._file_mb = folder, fps, robot, file_mb
        self._features = features | _COUNTED
        self._schema = pa.schema([(name, _arrow_type(each)) for name, each in self._features.items()])
        self._files = ExitStack()
        self._writer: pq.ParquetWriter | None = None
        self._file = -1
        self._frames = 0
        self._tasks: dict[str, int] = {}
        self._rows: list[dict[str, Any]] = []
        self._statistics: list[Statistics] = []
        self._sources: list[dict[str, Any]] = []

    @property
    def episodes(self) -> int:
        """Number of episodes so far."""
        return len(self._rows)

    def add(self, episode: Episode, source: dict[str, Any]) -> None:
        """Write an episode; `source` (plain values) says where it comes from. Raises OSError."""
        number, frames = self.episodes, episode.frames
        indexes = np.array([self._tasks.setdefault(each, len(self._tasks)) for each in episode.tasks])
        columns = episode.columns | {
            "timestamp": (np.arange(frames) / self._fps).astype(np.float32),
            "frame_index": np.arange(frames),
            "episode_index": np.full(frames, number),
            "index": np.arange(self._frames, self._frames + frames),
            "task_index": indexes[episode.task_of_frame],
        }
        arrays = [_arrow_array(columns[name], each) for name, each in self._features.items()]
        self._open_file().write_table(pa.table(arrays, schema=self._schema))
        statistics = {name: statistics_of(columns[name]) for name in self._features}
        self._statistics.append(statistics)
        chunk, file = divmod(self._file, FILES_PER_CHUNK)
        flat = {f"stats/{name}/{key}": each.tolist() for name, of in statistics.items() for key, each in of.items()}
        self._rows.append(
            {
                "episode_index": number,
                "tasks": list(episode.tasks),
                "length": frames,
                "data/chunk_index": chunk,
                "data/file_index": file,
                "dataset_from_index": self._frames,
                "dataset_to_index": self._frames + frames,
                **flat,
                "meta/episodes/chunk_index": 0,
                "meta/episodes/file_index": 0,
            }
        )
        self._sources.append({"episode_index": number, **source})
        self._frames += frames

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._files.close()
        if error is None and self._rows:
            self._finish()

    def _open_file(self) -> pq.ParquetWriter:
        """Return the writer of the present data file, or of the next one if that is full."""
        if self._writer is None or self._path().stat().st_size >= self._file_mb * 1_000_000:
            self._files.close()
            self._file += 1
            self._path().parent.mkdir(parents=True, exist_ok=True)
            self._writer = self._files.enter_context(pq.ParquetWriter(self._path(), self._schema))
        return self._writer

    def _path(self) -> Path:
        chunk, file = divmod(self._file, FILES_PER_CHUNK)
        return self._folder / "data" / _FILE.format(chunk_index=chunk, file_index=file)

    def _finish(self) -> None:
        meta = self._folder / "meta"
        episodes = meta / "episodes" / _FILE.format(chunk_index=0, file_index=0)
        episodes.parent.mkdir(parents=True)
        pq.write_table(pa.Table.from_pylist(self._rows), episodes)
        pq.write_table(_tasks_table(self._tasks), meta / "tasks.parquet")
        merged = merge_statistics(self._statistics)
        plain = {name: {key: value.tolist() for key, value in of.items()} for name, of in merged.items()}
        _write_json(plain, meta / "stats.json")
        _write_json({"episodes": self._sources}, meta / "kurt2rt.json")
        _write_json(self._info(), meta / "info.json")

    def _info(self) -> dict[str, Any]:
        return {
            "codebase_version": FORMAT,
            "robot_type": self._robot,
            "total_episodes": self.episodes,
            "total_frames": self._frames,
            "total_tasks": len(self._tasks),
            "chunks_size": FILES_PER_CHUNK,
            "data_files_size_in_mb": self._file_mb,
            "video_files_size_in_mb": 200,
            "fps": self._fps,
            "splits": {"train": f"0:{self.episodes}"},
            "data_path": f"data/{_FILE}",
            "video_path": None,
            "features": {
                name: {"dtype": each.dtype, "shape": [each.length], "names": each.names and list(each.names)}
                for name, each in self._features.items()
            },
        }


def _arrow_type(feature: Feature) -> pa.DataType:
    value = pa.from_numpy_dtype(np.dtype(feature.dtype))
    return value if feature.names is None else pa.list_(value, feature.length)


def _arrow_array(values: Column, feature: Feature) -> pa.Array:
    if feature.names is None:
        return pa.array(values)
    return pa.FixedSizeListArray.from_arrays(pa.array(np.ascontiguousarray(values).reshape(-1)), feature.length)


def _tasks_table(tasks: dict[str, int]) -> pa.Table:
    """Return the numbers of the tasks, with the metadata by which pandas takes the texts for the index."""
    index = "__index_level_0__"
    names = (("task_index", "task_index", "int64"), (None, index, "unicode"))
    columns = [
        {"name": name, "field_name": at, "pandas_type": kind, "numpy_type": kind, "metadata": None}
        for name, at, kind in names
    ]
    about = {"index_columns": [index], "column_indexes": [], "columns": columns, "pandas_version": "2.0.0"}
    table = pa.table({"task_index": pa.array(tasks.values(), pa.int64()), index: pa.array(tasks)})
    return table.replace_schema_metadata({"pandas": json.dumps(about)})


def _source_of(run: Run, episode: Episode) -> dict[str, Any]:
    head = run.head
    return {
        "run": Path(run.name).name,
        "started_at": head.started_at,
        "task": head.task,
        "bus": head.bus,
        "kurt2rt": head.kurt2rt,
        "first_tick": episode.first_tick,
        "began_s": episode.began_s,
    }


def _write_json(content: dict[str, Any], path: Path) -> None:
    path.write_text(json.dumps(content, indent=4, ensure_ascii=False), encoding="utf-8")


@contextmanager
def _new_folder(folder: Path) -> Iterator[Path]:
    """Yield a temporary folder next to `folder`, which takes its name at the end; after an error it is deleted."""
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise RecordingError("something is there already", where=folder, do="give the name of a new folder")
    folder.parent.mkdir(parents=True, exist_ok=True)
    part = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
    try:
        yield part
        part.chmod(0o755)
        part.replace(folder)
    finally:
        shutil.rmtree(part, ignore_errors=True)


def statistics_of(values: Column) -> dict[str, Column]:
    """Return least, largest, mean, deviation and quantiles of a column, each (length,), and count (1,)."""
    wide = values.reshape(len(values), -1)
    # One value at a time: in float64, an hour of all of them takes as much memory as the rest of the export.
    quantiles = np.stack([np.quantile(each.astype(np.float64), _QUANTILES) for each in wide.T], axis=1)
    return {
        "min": wide.min(axis=0).astype(np.float64),
        "max": wide.max(axis=0).astype(np.float64),
        "mean": wide.mean(axis=0, dtype=np.float64),
        "std": np.array([each.std(dtype=np.float64) for each in wide.T]),
        "count": np.array([len(wide)]),
        **{f"q{round(100 * share):02d}": each for share, each in zip(_QUANTILES, quantiles, strict=True)},
    }


def merge_statistics(of_episodes: Sequence[Statistics]) -> Statistics:
    """Return the statistics of all episodes together; quantiles are means weighted by count, as LeRobot's are."""
    merged = {}
    for name in of_episodes[0]:
        stacked = {key: np.stack([each[name][key] for each in of_episodes]) for key in of_episodes[0][name]}
        counts = stacked["count"]
        total = counts.sum(axis=0)
        means = {key: (each * counts).sum(axis=0) / total for key, each in stacked.items()}
        variance = ((stacked["std"] ** 2 + (stacked["mean"] - means["mean"]) ** 2) * counts).sum(axis=0) / total
        merged[name] = means | {
            "min": stacked["min"].min(axis=0),
            "max": stacked["max"].max(axis=0),
            "std": np.sqrt(variance),
            "count": total,
        }
    return merged
