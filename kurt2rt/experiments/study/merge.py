"""Merge of result folders: results of the same studies, made on several machines, go into one folder."""

import filecmp
import hashlib
import shutil
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from hal.settings import Settings
from kurt2rt.experiments.study.provenance import Provenance
from kurt2rt.experiments.study.results import Results, StudyError
from kurt2rt.experiments.study.study_record import JobRecord, StudyRecord, read_records, write_record
from kurt2rt.knowledge.files.archive_existing import archive_existing
from kurt2rt.platform.durable_files import fsync_file, write_durably

_MAKE_AGAIN = "leave this part out, or make it again"


@dataclass(frozen=True, slots=True)
class MergedPart:
    """Part of a merge."""

    folder: Path
    results: int
    copied: int
    """Results that were not in the merged folder before."""


@dataclass(frozen=True, slots=True)
class MergeResult:
    """Result of a merge."""

    parts: tuple[MergedPart, ...]
    records: tuple[StudyRecord, ...]
    """Studies of the merged folder."""


class _AnyResult(Settings, extra="ignore"):
    made_of: Provenance


@dataclass(frozen=True, slots=True)
class _Part:
    folder: Path
    records: tuple[StudyRecord, ...]

    @property
    def done(self) -> dict[str, JobRecord]:
        """Jobs that have a result here, by its path."""
        jobs = {job.file: job for record in self.records for job in record.jobs}
        return {file: job for file, job in jobs.items() if (self.folder / file).exists()}


def merge_results(out: Path, folders: Sequence[Path]) -> MergeResult:
    """Copy the results and knowledge of all `folders` to `out`; results that it holds already stay.

    All is checked before anything is copied. A merge that was interrupted goes on if it is run again.

    Raises:
        StudyError: a part has no study, is written to, or was made of other source, settings or versions; or a job has
            two results that differ.
        OSError: a file cannot be read or written.
    """
    if len({folder.resolve() for folder in (out, *folders)}) <= len(folders):
        raise StudyError("a folder was named twice", do="name the merged folder, and each part once")
    with ExitStack() as locks:
        parts = [_open_part(folder, locks) for folder in folders]
        results = Results(out)
        locks.enter_context(results.held())
        merged = [_Part(out, tuple(read_records(out)))] if (out / "studies").exists() else []
        _require_one_study([*merged, *parts])
        _require_equal_results([*merged, *parts])
        for record in (record for part in parts for record in part.records):
            write_record(out, record)
        copied = tuple(MergedPart(part.folder, len(part.done), _copy(part, results)) for part in parts)
        return MergeResult(copied, tuple(read_records(out)))


def _open_part(folder: Path, locks: ExitStack) -> _Part:
    part = _Part(folder, tuple(read_records(folder)))
    locks.enter_context(Results(folder).unchanged())
    stray = sorted(set(_result_files(folder)) - set(part.done))
    if stray:
        raise StudyError(
            f"{stray[0]} belongs to no study that is recorded there",
            where=folder,
            do="run the command that made it again with this folder, which records it",
        )
    for job in part.done.values():
        if job.knowledge is not None and not (folder / job.knowledge).exists():
            raise StudyError(
                f"{job.knowledge} is gone, and {job.file} stands", where=folder, do="delete that too, and run again"
            )
    return part


def _result_files(folder: Path) -> Iterator[str]:
    return (path.relative_to(folder).as_posix() for path in (folder / "results").rglob("*.json"))


def _require_one_study(parts: Sequence[_Part]) -> None:
    """Check that all parts know each job by the same settings, source and versions. Raises StudyError."""
    known: dict[str, tuple[JobRecord, Path]] = {}
    commands: dict[str, tuple[StudyRecord, Path]] = {}
    for part in parts:
        for record in part.records:
            for job in record.jobs:
                first, whose = known.setdefault(job.file, (job, part.folder))
                _require_same_make(part.folder, job.file, job.made_of, first.made_of, whose)
            same, whose = commands.setdefault(record.file, (record, part.folder))
            if not same.is_same_study(record):
                raise StudyError(
                    f"has other jobs than {whose} for the command {record.command}", where=part.folder, do=_MAKE_AGAIN
                )


def _require_same_make(folder: Path, file: str, made: Provenance, known: Provenance, whose: Path) -> None:
    differing = made.differences(known)
    if differing:
        name = differing[-1]  # another version or source explains more than settings, which stand first
        raise StudyError(
            f"{file} was made with other {name} than in {whose} (got {getattr(made, name)}, "
            f"allowed {getattr(known, name)})",
            where=folder,
            do=_MAKE_AGAIN,
        )


def _require_equal_results(parts: Sequence[_Part]) -> None:
    """Check that results are of their recorded make, and equal if a job was done twice. Raises StudyError."""
    known: dict[str, tuple[str, Path]] = {}
    for part in parts:
        for file, job in part.done.items():
            content = (part.folder / file).read_bytes()
            try:
                made = _AnyResult.model_validate_json(content).made_of
            except ValidationError as error:
                raise StudyError("is no result of this program", where=part.folder / file, do=_MAKE_AGAIN) from error
            _require_same_make(part.folder, file, made, job.made_of, part.folder)
            digest = hashlib.sha256(content).hexdigest()
            first, whose = known.setdefault(file, (digest, part.folder))
            if first != digest:
                raise StudyError(
                    f"{job.name} has another result than in {whose} ({file})",
                    where=part.folder,
                    do="a job has one result on all machines: do it again on a third one, and leave the wrong one out",
                )


def _copy(part: _Part, results: Results) -> int:
    """Copy the results of a part that are missing, each after its knowledge; return their number. Raises OSError."""
    missing = [job for file, job in part.done.items() if not (results.folder / file).exists()]
    for job in missing:
        if job.knowledge is not None:
            _copy_knowledge(part.folder, job.knowledge, results)
        write_durably(results.folder / job.file, (part.folder / job.file).read_text(encoding="utf-8"))
    return len(missing)


def _copy_knowledge(folder: Path, name: str, results: Results) -> None:
    """Copy a knowledge file; another file in its place gets a new name. Raises KnowledgeError, OSError."""
    target = results.folder / name
    if target.exists() and filecmp.cmp(folder / name, target, shallow=False):
        return
    with results.scratch() as scratch:
        shutil.copyfile(folder / name, scratch / "knowledge")
        fsync_file(scratch / "knowledge")
        archive_existing(target)
        results.keep(scratch / "knowledge", name)
