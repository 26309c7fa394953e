"""The folder where results are kept: one file per job, so that a run which was interrupted goes on where it was."""

import fcntl
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO, Protocol, TypeVar

from pydantic import ValidationError

from config.errors import UserError
from config.settings import Settings
from kurt2rt.experiments.study.provenance import Provenance
from kurt2rt.platform.durable_files import write_durably

_UNFINISHED = "unfinished-"
_NEW_FOLDER = "give a new folder with --out, or delete the results in this one"

OutcomeT = TypeVar("OutcomeT", bound=Settings)


class StudyError(UserError):
    """Stored results cannot be used, or experiments do not fit together."""


class StoredResult(Protocol):
    """Job with a stored result."""

    @property
    def file(self) -> str:
        """Path of the result within the folder of results."""
        ...

    @property
    def made_of(self) -> Provenance:
        """Hashes of what made the result; a result of another making is refused."""
        ...

    @property
    def outcome(self) -> type[Settings]:
        """Class of its outcome, which is the schema of the file."""
        ...

    @property
    def replaces_others(self) -> bool:
        """True if the job runs again, and replaces its result, if that is of other settings; False: it is refused."""
        ...


class _AnyOutcome(Settings, extra="ignore"):
    made_of: Provenance


class Results:
    """A folder of results. Can be sent to another process."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    @contextmanager
    def held(self) -> Iterator[None]:
        """Make the folder, lock it against other runs, and remove unfinished jobs of an interrupted run.

        Raises StudyError while another run writes there, OSError where nothing can be written.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        with (self.folder / ".lock").open("ab") as lock:
            self._lock(lock)
            for left_over in self.folder.glob(f"{_UNFINISHED}*"):
                shutil.rmtree(left_over)
            yield

    def _lock(self, lock: BinaryIO) -> None:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise StudyError(
                "another run writes here",
                where=self.folder,
                do="wait for its end, or give another folder with --out",
            ) from error

    @contextmanager
    def scratch(self) -> Iterator[Path]:
        """Yield a temporary folder for an unfinished job, deleted at the end of the context. Raises OSError."""
        with tempfile.TemporaryDirectory(prefix=_UNFINISHED, dir=self.folder) as folder:
            yield Path(folder)

    def missing(self, jobs: Sequence[StoredResult]) -> list[int]:
        """Return the indexes of the jobs that have no result yet.

        Raises StudyError if there are results of other settings, source or versions, or damaged files: they are never
        mixed.
        """
        foreign: list[str] = []
        differences: set[str] = set()
        missing = []
        for place, job in enumerate(jobs):
            path = self.folder / job.file
            if not path.exists():
                missing.append(place)
                continue
            other = self._read(path, _AnyOutcome).made_of.differences(job.made_of)
            if other and job.replaces_others:
                missing.append(place)
            elif other:
                foreign.append(job.file)
                differences.update(other)
            else:
                self.read(job, job.outcome)
        if foreign:
            what = ", ".join(name for name in Provenance.model_fields if name in differences)
            more = f" and {len(foreign) - 1} more" if len(foreign) > 1 else ""
            raise StudyError(
                f"{foreign[0]}{more} were made with other settings or another program (what differs: {what})",
                where=self.folder,
                do=_NEW_FOLDER,
            )
        return missing

    def write(self, job: StoredResult, outcome: Settings) -> None:
        """Store the outcome of a job, whole and durable. Raises OSError."""
        write_durably(self.folder / job.file, outcome.model_dump_json() + "\n")

    def read(self, job: StoredResult, schema: type[OutcomeT]) -> OutcomeT:
        """Return the outcome of a job. Raises StudyError if it is missing, damaged or of another schema."""
        return self._read(self.folder / job.file, schema)

    def keep(self, file: Path, name: str) -> None:
        """Move a finished file out of the scratch folder to `name`, a path within the folder of results.

        Raises OSError.
        """
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        file.replace(path)

    @staticmethod
    def _read(path: Path, schema: type[OutcomeT]) -> OutcomeT:
        try:
            return schema.model_validate_json(path.read_bytes())
        except (ValidationError, OSError) as error:
            raise StudyError("is not a result of this program", where=path, do=_NEW_FOLDER) from error
