"""Recorded run: its initial state and its ticks."""

from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TypeVar

from pydantic import ValidationError

from config.plugins import settings_from_elsewhere
from config.settings import SettingsError
from hal.robot_settings import RobotSettings, robot_of_json
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.knowledge.exchange.attachment_files import extracted_settings, unsafe_reason
from kurt2rt.knowledge.exchange.attachments import (
    KNOWLEDGE,
    ROBOT,
    SETTINGS,
    STATISTICS,
    TASK,
    decode_lessons,
    decode_statistics,
    hash_attachments,
)
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.runs.recording.entries import TickEntry
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.recording.run_head import RunHead

DecodedT = TypeVar("DecodedT")
Report = Callable[[str, float, float], None]
"""Callback with a run's name, its seconds that were read, and its whole length in s."""
_REPORT_EVERY_TICKS = 500


@dataclass(frozen=True, slots=True)
class RunSource:
    """Functions by which a `Run` reads its ticks from files; each call reads again from the beginning."""

    ticks: Callable[[], Iterator[TickEntry]]
    truncated: Callable[[], str] = str
    """Reason why the last reading ended early, in a sentence; empty if it did not."""
    ends_s: Callable[[], float] = float
    """Time of the last tick."""
    without_gap: Callable[[], bool] = bool
    """True if no tick is missing before the last, found without decoding all of them."""
    stamps: Callable[[], Iterator[tuple[str, str]]] = lambda: iter(())
    """Command ids of durable lessons with their times."""


class Run:
    """Recorded run of the robot program: settings and knowledge at its start, and its ticks."""

    def __init__(
        self, name: str, head: RunHead, attachments: Mapping[str, bytes], source: RunSource, *, partial: bool = False
    ) -> None:
        """Check the initial state. `partial`: accept a run whose beginning was deleted; it cannot be replayed.

        Raises RecordingError if settings or knowledge of the run are missing or damaged.
        """
        self.name = name
        self.head = head
        self._attachments = attachments
        self._source = source
        self._partial = partial
        self._gap = ""
        self.began_s: float | None = None
        """Runtime clock at the first tick; None until that tick was read."""
        self._check()

    @property
    def trouble(self) -> str:
        """Reason that `entries` ended early, in a sentence; empty if it did not so far."""
        return self._gap or self._source.truncated()

    @property
    def duration_s(self) -> float:
        """Time of the runtime's clock in s from the first tick to the last; 0 if unknown. Reads the last segment.

        Raises RecordingError.
        """
        first = next(self.entries(), None)
        return 0.0 if first is None else max(self._source.ends_s() - first.now_s, 0.0)

    @property
    def duration_without_gap_s(self) -> float:
        """Time in s from the first tick to the last that can be replayed, before any gap.

        Reads all those ticks if there is a gap. Raises RecordingError.
        """
        if self._source.without_gap():
            return self.duration_s
        newest = 0.0
        for entry in self.entries():
            newest = self.elapsed_s(entry)
        return newest

    def elapsed_s(self, entry: TickEntry) -> float:
        """Return the time in s from the first tick to the entry's; the first tick must have been read."""
        return 0.0 if self.began_s is None else entry.now_s - self.began_s

    @property
    def has_no_gap(self) -> bool:
        """Return whether the ticks read so far had no gap; the end may be missing."""
        return not self._gap

    @cached_property
    def robot(self) -> RobotSettings:
        """Settings of the robot in the run. Raises SettingsError if its kind is not installed."""
        with settings_from_elsewhere():
            return robot_of_json(self._attachments[ROBOT], "the robot of the run")

    @cached_property
    def task(self) -> TaskSettings:
        """Settings of the task in the run."""
        with settings_from_elsewhere():
            return TaskSettings.model_validate_json(self._attachments[TASK])

    @cached_property
    def lessons(self) -> tuple[JournalEntry, ...]:
        """Lessons from before the run; empty if its beginning was deleted. Raises RecordingError."""
        data = self._attachments.get(KNOWLEDGE)
        return () if data is None else tuple(_decoded(decode_lessons, data))

    def stamps(self, command_ids: Collection[str]) -> dict[str, str]:
        """Return the UTC times at which these lessons became durable, by command id; others are left out.

        Reads until all are found. Raises RecordingError.
        """
        found: dict[str, str] = {}
        if command_ids:
            for command_id, stamp in self._source.stamps():
                if command_id in command_ids:
                    found[command_id] = stamp
                    if len(found) == len(command_ids):
                        break
        return found

    @cached_property
    def saved(self) -> Statistics:
        """Statistics from before the run. Raises RecordingError."""
        data = self._attachments.get(STATISTICS)
        return Statistics() if data is None else _decoded(decode_statistics, data)

    @contextmanager
    def settings(self) -> Iterator[None]:
        """Put the run's own settings in force inside the context. Raises RecordingError."""
        kept = {name: data for name, data in self._attachments.items() if name.startswith(SETTINGS)}
        with ExitStack() as stack:
            try:
                stack.enter_context(extracted_settings(kept))
            except OSError as error:
                raise RecordingError(
                    f"its settings cannot be laid out ({error})",
                    where=self.name,
                    do="make room where temporary files go",
                ) from error
            yield

    def require_beginning(self) -> None:
        """Raise RecordingError if the initial knowledge is missing, so that nothing can be replayed."""
        first = None if KNOWLEDGE in self._attachments else next(self._source.ticks(), None)
        if first is None or first.number == 1:
            self._require(KNOWLEDGE)
            return
        minutes = (first.number - 1) * self.robot.cycle_s / 60
        raise RecordingError(
            f"is there from its tick {first.number} on; the {minutes:.1f} min before have gone to make room "
            "for later ones, and with them what was known at the start, so it can neither be replayed nor "
            "one of its decisions be explained. kurt2rt why --from 0 tells what is there",
            where=self.name,
            do="raise recordings_mb for the next",
        )

    def entries(self) -> Iterator[TickEntry]:
        """Yield the ticks from the first to the end or to the first gap. Raises RecordingError."""
        self._gap = ""
        for number, entry in enumerate(self._source.ticks(), start=1):
            if number == 1:
                self.began_s = entry.now_s
            if entry.number != number:
                missing = entry.number - number
                self._gap = (
                    f"{missing} ticks before {self.elapsed_s(entry):.2f} s (tick {entry.tick}) are not in the "
                    "recording, so what came after them cannot be replayed"
                )
                return
            yield entry

    def partial_entries(self) -> Iterator[TickEntry]:
        """Yield all ticks, also after gaps; `trouble` names the gaps. Raises RecordingError."""
        self._gap = ""
        newest = missing = gaps = 0
        for entry in self._source.ticks():
            if newest == 0:
                self.began_s = entry.now_s
            if entry.number > newest + 1 and newest == 0 and KNOWLEDGE not in self._attachments:
                self._gap = self._beginning_gone(entry.number - 1)
            elif entry.number > newest + 1:
                missing += entry.number - newest - 1
                gaps += 1
            newest = entry.number
            yield entry
        if gaps:
            where = "in one place" if gaps == 1 else f"in {gaps} places"
            told = f"{missing} ticks {where} are not in the recording"
            self._gap = f"{self._gap}; {told}" if self._gap else told

    def _beginning_gone(self, ticks: int) -> str:
        minutes = ticks * self.robot.cycle_s / 60
        return (
            f"the first {ticks} ticks of the run ({minutes:.1f} min) are gone, which made room for later ones; times "
            "are those from the first tick that is there"
        )

    def _check(self) -> None:
        self._require(ROBOT, TASK)
        if not self._partial:
            self.require_beginning()
        trouble = unsafe_reason({name: len(data) for name, data in self._attachments.items()})
        if trouble:
            raise RecordingError(trouble, where=self.name, do="give a run as kurt2rt run recorded it")
        found = hash_attachments(self._attachments)
        for name, fingerprint in self.head.fingerprints.items():
            if name in found and found[name] != fingerprint:
                raise RecordingError(f"{name} is damaged", where=self.name, do="give another copy of the run")
        try:
            _ = self.robot, self.task
        except (ValidationError, SettingsError) as error:
            raise RecordingError(
                f"was recorded by kurt2rt {self.head.kurt2rt}, whose settings this one cannot use ({_told(error)})",
                where=self.name,
                do="replay it with that one",
            ) from error

    def _require(self, *names: str) -> None:
        missing = [name for name in names if name not in self._attachments]
        if missing:
            raise RecordingError(
                f"{', '.join(missing)} is missing, with which the run began",
                where=self.name,
                do=(
                    "its first segment may have gone to make room for later ones: give a whole run, or "
                    "raise recordings_mb for the next"
                ),
            )


def _told(error: ValidationError | SettingsError) -> str:
    if isinstance(error, SettingsError):
        return error.what
    problem = error.errors(include_url=False)[0]
    return f"{'.'.join(map(str, problem['loc']))}: {problem['msg']}"


def _decoded(decode: Callable[[bytes], DecodedT], data: bytes) -> DecodedT:
    """Decode an attachment. Raises RecordingError."""
    try:
        return decode(data)
    except ValueError as error:
        raise RecordingError(str(error)) from error


def progress_reporter(run: Run, report: Report) -> Callable[[TickEntry], None]:
    """Return a callback for each tick that is read of a run; it calls `report` every 500 ticks."""
    name, whole_s = Path(run.name).name, run.duration_s

    def on_entry(entry: TickEntry) -> None:
        if entry.number % _REPORT_EVERY_TICKS == 1:
            done_s = run.elapsed_s(entry)
            report(name, done_s, max(whole_s, done_s))

    return on_entry
