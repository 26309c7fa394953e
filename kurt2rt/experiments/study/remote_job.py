"""RemoteJob: a job with the files that it needs, to be run on another machine, and the files that it gives."""

import pickle
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextvars import Context
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

from threadpoolctl import threadpool_limits

from config.errors import UserError
from kurt2rt.experiments.study.jobs import Results, StoredJob
from kurt2rt.experiments.study.provenance import program_hash, versions_with_python
from kurt2rt.knowledge.files.archive_existing import archive_existing
from kurt2rt.platform.durable_files import fsync_file, write_durably


class WorkerDiffersError(UserError):
    """Worker of a cluster that has another program, or came to another result than its witness."""


class RemoteJob(NamedTuple):
    """Job of a study with all files that it reads, for a worker on a machine without the sender's disk."""

    job: bytes
    """Pickled job."""
    folder: str
    """Folder of results of the sender."""
    earlier: Mapping[str, bytes]
    """Files of the robot's earlier jobs, by path within the folder of results."""
    inputs: Mapping[str, bytes]
    """Other files that the job names, by the sender's path."""
    program: str
    """Hash of the sender's program."""


def pack(job: StoredJob, results: Results, earlier: Iterable[StoredJob]) -> RemoteJob:
    """Return the remote job of a job; `earlier`: jobs of the same robot that are done. Raises OSError."""
    names = [name for each in earlier for name in _files_of(each)]
    inputs = {path for path in _paths(job) if path.is_file()} - {results.folder / name for name in names}
    return RemoteJob(
        pickle.dumps(job),
        str(results.folder),
        {name: (results.folder / name).read_bytes() for name in names},
        {str(path): path.read_bytes() for path in inputs},
        _program(),
    )


def run_remote_job(remote_job: RemoteJob) -> dict[str, bytes]:
    """Run a remote job in a temporary folder; return the files that it gives, by path within it.

    Raises:
        WorkerDiffersError: this machine has another program than the sender.
        Exception: any error of the job.
    """
    if _program() != remote_job.program:
        raise WorkerDiffersError(
            f"the worker's program is another one (got {_program()}, allowed {remote_job.program})",
            do="install the same version of kurt2rt and its packages on both",
        )
    with tempfile.TemporaryDirectory(prefix="kurt2rt-") as name, threadpool_limits(limits=1):
        made = Path(name) / "made"
        for file, content in remote_job.earlier.items():
            _write(made / file, content)
        inputs = {}
        for number, (file, content) in enumerate(remote_job.inputs.items()):
            inputs[file] = Path(name) / f"inputs/{number}/{Path(file).name}"
            _write(inputs[file], content)
        made.mkdir(exist_ok=True)
        folder = Path(remote_job.folder)

        def move(path: Path) -> Path:
            if str(path) in inputs:
                return inputs[str(path)]
            return made / path.relative_to(folder) if path == folder or folder in path.parents else path

        job: StoredJob = _moved(pickle.loads(remote_job.job), move)
        # anyio marks the worker's event loop in a context variable, which Dask copies to the thread of the job.
        Context().run(job.run, lambda _done_s: None)
        return {file: (made / file).read_bytes() for file in _files_of(job)}


def unpack(job: StoredJob, results: Results, files: Mapping[str, bytes]) -> None:
    """Store the files that a job gave, the result last; another knowledge file in their place gets a new name.

    Raises KnowledgeError, OSError.
    """
    if job.knowledge_name is not None:
        with results.scratch() as scratch:
            (scratch / "knowledge").write_bytes(files[job.knowledge_name])
            fsync_file(scratch / "knowledge")
            archive_existing(results.folder / job.knowledge_name)
            results.keep(scratch / "knowledge", job.knowledge_name)
    write_durably(results.folder / job.file, files[job.file].decode("utf-8"))


def _program() -> str:
    """Return what two machines must have alike: the program with its settings, and the packages that compute."""
    return f"{program_hash('.py', '.yaml', '.dbc', '.json', '.png', '.pgm')}, {versions_with_python()}"


def _files_of(job: StoredJob) -> list[str]:
    return [job.file] if job.knowledge_name is None else [job.knowledge_name, job.file]


def _write(path: Path, content: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)


def _paths(value: object) -> Iterator[Path]:
    """Yield all paths in the fields of a job, and of jobs within it."""
    if isinstance(value, Path):
        yield value
    elif is_dataclass(value) and not isinstance(value, type):
        for field in fields(value):
            yield from _paths(getattr(value, field.name))


def _moved(value: Any, move: Callable[[Path], Path]) -> Any:
    """Return a job, and the jobs within it, with other paths."""
    if isinstance(value, Path):
        return move(value)
    if isinstance(value, Results):
        return Results(move(value.folder))
    if is_dataclass(value) and not isinstance(value, type):
        changed = {}
        for field in fields(value):
            old = getattr(value, field.name)
            new = _moved(old, move)
            if new is not old:
                changed[field.name] = new
        return replace(value, **changed) if changed else value
    return value
