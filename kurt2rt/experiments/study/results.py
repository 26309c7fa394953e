"""Stored results of a study: its jobs, and a folder with a file for each, so that an interrupted run goes on."""

import fcntl
import shutil
import tempfile
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, TypeVar

from pydantic import ValidationError

from config.errors import UserError
from config.settings import Settings
from kurt2rt.experiments.study.provenance import Provenance
from kurt2rt.platform.durable_files import write_durably

_UNFINISHED = "unfinished-"
_NEW_FOLDER = "give a new folder with --out, or delete the results in this one"

Progress = Callable[[float], None]
"""Takes the simulated seconds of a job so far."""
OutcomeT = TypeVar("OutcomeT", bound=Settings)


class StudyError(UserError):
    """Stored results cannot be used, or experiments do not fit together."""


class Outcome(Settings):
    """Result of a job as its study stores it in JSON, with what made it."""

    made_of: Provenance
    seed: int


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredJob(ABC):
    """Job that can be sent to another process, and leaves its result in a file."""

    outcome: ClassVar[type[Settings]]
    """Schema of the result."""
    replaces_others: ClassVar[bool] = False
    """True if the job runs again, and replaces its result, if that is of other settings; False: it is refused."""
    keeps_knowledge: ClassVar[bool] = True
    results: "Results"
    seed: int
    """Seed of the robot; jobs of other robots need none of its files."""
    made_of: Provenance
    name: str
    """Name in progress displays."""
    stem: str
    """Path of result and knowledge, without the top folder and the ending."""
    robot_time_s: float
    """Simulated time in s, at most."""
    wave: int = 0
    """The job needs results of earlier waves only."""

    @property
    def file(self) -> str:
        """Path of the result within the folder of results."""
        return f"results/{self.stem}.json"

    @property
    def knowledge_name(self) -> str | None:
        """Path of the stored knowledge within the folder of results; None: the job stores none."""
        return f"knowledge/{self.stem}.knowledge" if self.keeps_knowledge else None

    @property
    def knowledge(self) -> Path:
        """Path of the stored knowledge file; it exists after the job."""
        assert self.knowledge_name is not None
        return self.results.folder / self.knowledge_name

    @abstractmethod
    def run(self, on_progress: Progress) -> None:
        """Run the job, and store result and knowledge; any error of the job is raised."""


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
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError as error:
                do = "wait for its end, or give another folder with --out"
                raise StudyError("another run writes here", where=self.folder, do=do) from error
            for left_over in self.folder.glob(f"{_UNFINISHED}*"):
                shutil.rmtree(left_over)
            yield

    @contextmanager
    def scratch(self) -> Iterator[Path]:
        """Yield a temporary folder for an unfinished job, deleted at the end of the context. Raises OSError."""
        with tempfile.TemporaryDirectory(prefix=_UNFINISHED, dir=self.folder) as folder:
            yield Path(folder)

    def missing(self, jobs: Sequence[StoredJob]) -> list[int]:
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

    def write(self, job: StoredJob, outcome: Settings) -> None:
        """Store the outcome of a job, whole and durable. Raises OSError."""
        write_durably(self.folder / job.file, outcome.model_dump_json() + "\n")

    def read(self, job: StoredJob, schema: type[OutcomeT]) -> OutcomeT:
        """Return the outcome of a job. Raises StudyError if it is missing, damaged or of another schema."""
        return self._read(self.folder / job.file, schema)

    def keep(self, file: Path, name: str) -> None:
        """Move a finished file out of the scratch folder to `name`, a path within this folder. Raises OSError."""
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        file.replace(path)

    @staticmethod
    def _read(path: Path, schema: type[OutcomeT]) -> OutcomeT:
        try:
            return schema.model_validate_json(path.read_bytes())
        except (ValidationError, OSError) as error:
            raise StudyError("is not a result of this program", where=path, do=_NEW_FOLDER) from error
