"""Record of a study in its folder: the command, and all jobs with their provenance, done or not."""

import os
import stat
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path, PurePosixPath
from typing import Annotated, Self

from pydantic import AfterValidator, ValidationError, field_validator

from hal.settings import Settings
from kurt2rt.experiments.study.plan import StudyPlan
from kurt2rt.experiments.study.provenance import Provenance, settings_hash
from kurt2rt.experiments.study.results import StudyError
from kurt2rt.platform.durable_files import write_durably

_FOLDER = "studies"
WITNESSES = "witnesses"
"""Folder, within that of the results, of comparisons of the batch with the CAN bus."""


def _require_printable(text: str) -> str:
    """Refuse signs that a terminal would obey, because records come from other machines."""
    if not text.isprintable():
        raise ValueError("it cannot be printed")
    return text


def _stay_within(path: str) -> str:
    """Refuse a path that leads out of the folder, because records come from other machines."""
    if PurePosixPath(path).is_absolute() or ".." in PurePosixPath(path).parts:
        raise ValueError("it leads out of the folder")
    return path


_Text = Annotated[str, AfterValidator(_require_printable)]
_Path = Annotated[_Text, AfterValidator(_stay_within)]


class JobRecord(Settings):
    """Job of a study, done or not."""

    file: _Path
    """Path of the result within the folder of results."""
    knowledge: _Path | None
    """Path of the knowledge within the folder of results; None: the job stores none."""
    name: _Text
    seed: int
    made_of: Provenance

    @field_validator("made_of")
    @classmethod
    def _is_printable(cls, made_of: Provenance) -> Provenance:
        for name in Provenance.model_fields:
            _require_printable(getattr(made_of, name))
        return made_of

    @property
    def is_witness(self) -> bool:
        """Return whether it compares the batch with the CAN bus, and a study on the CAN bus alone does without it."""
        return self.file.startswith(f"results/{WITNESSES}/")


class StudyRecord(Settings):
    """Command and jobs of a study, of all its shards."""

    command: _Text
    """Typed words that decide the numbers, without paths of a machine."""
    jobs: tuple[JobRecord, ...]

    @property
    def file(self) -> str:
        """Path of the record within the folder of results."""
        return f"{_FOLDER}/{settings_hash(self.command)}.json"

    @property
    def sources(self) -> list[str]:
        """Hashes of the program's source, each once."""
        return list(dict.fromkeys(job.made_of.source for job in self.jobs))

    @property
    def versions(self) -> list[str]:
        """Versions of Python and of the computing packages, each set once."""
        return list(dict.fromkeys(job.made_of.versions for job in self.jobs))

    def with_witnesses(self, other: Self) -> Self:
        """Return the record with the witnesses of another record of its command, too."""
        own = {job.file for job in self.jobs}
        more = tuple(job for job in other.jobs if job.is_witness and job.file not in own)
        return self.model_copy(update={"jobs": (*self.jobs, *more)})

    def is_same_study(self, other: Self) -> bool:
        """Return whether another record has the same jobs, besides witnesses."""
        return [job for job in self.jobs if not job.is_witness] == [job for job in other.jobs if not job.is_witness]

    def missing(self, folder: Path) -> list[JobRecord]:
        """Return the jobs that have no result in a folder."""
        return [job for job in self.jobs if not (folder / job.file).exists()]


def record_study(folder: Path, plan: StudyPlan, command: str) -> None:
    """Store the record of the whole plan in a folder of results, in place of an earlier one of its command.

    Witnesses of the earlier one stay, because those on the CAN bus alone are not planned.

    `command`: typed words that decide the numbers. Raises OSError.
    """
    jobs = (
        JobRecord(file=job.file, knowledge=job.knowledge_name, name=job.name, seed=job.seed, made_of=job.made_of)
        for wave in plan.waves
        for job in wave
    )
    write_record(folder, StudyRecord(command=command, jobs=tuple(jobs)))


def write_record(folder: Path, record: StudyRecord) -> None:
    """Store a record in a folder of results, in place of an earlier one of its command, but with its witnesses.

    Raises OSError.
    """
    if (folder / record.file).exists():
        with suppress(StudyError):  # a damaged one has no witnesses
            record = record.with_witnesses(*_each_record([folder / record.file]))
    write_durably(folder / record.file, record.model_dump_json(indent=1) + "\n")


def read_records(folder: Path) -> list[StudyRecord]:
    """Return the records in a folder of results, which may be of another machine.

    Raises StudyError for a damaged record, a folder without any, and one with links, pipes or devices in it.
    """
    _require_regular(folder)
    records = list(_each_record(sorted((folder / _FOLDER).glob("*.json"))))
    if not records:
        raise StudyError("holds no study", where=folder, do="give the folder that a study was given with --out")
    return records


def _require_regular(folder: Path) -> None:
    """Refuse a folder with anything in it but files and folders, because a pipe is waited for, and a link leads out."""
    for at, folders, files in os.walk(folder):
        for name in (*folders, *files):
            with suppress(FileNotFoundError):  # of a job that just ended
                mode = Path(at, name).lstat().st_mode
                if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode)) or not name.isprintable():
                    raise StudyError(
                        f"holds {name!a}, which is neither file nor folder, or has no printable name",
                        where=folder,
                        do="remove it, or get another copy of the folder",
                    )


def _each_record(paths: Iterable[Path]) -> Iterable[StudyRecord]:
    for path in paths:
        try:
            yield StudyRecord.model_validate_json(path.read_bytes())
        except (ValidationError, OSError) as error:
            raise StudyError(
                "is no record of a study", where=path, do="run the study's command again, which writes it"
            ) from error
