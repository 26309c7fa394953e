"""The files of the run that is being recorded, one after the other, within a budget, on a disk that may fail."""

import contextlib
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from foxglove import Context

from kurt2rt.knowledge.exchange.attachments import ROBOT, TASK
from kurt2rt.runs.recording.disk import Disk, LockedFolder, RealDisk
from kurt2rt.runs.recording.run_folder import make_room, next_run_name, segment_name, used_bytes
from kurt2rt.runs.recording.segment import Segment

_MEGA = 1_000_000
_MAX_SAME_NAME = 1000
_IN_EACH = (ROBOT, TASK)
"""Attachments of every segment, so that one can be understood whose elders had to make room."""


@dataclass(frozen=True, slots=True)
class Budget:
    """How much of the disk recordings may take."""

    total_bytes: int
    """Of all runs together."""
    segment_bytes: int
    """A segment that has grown so far is the last but one."""
    reserve_bytes: int = 200 * _MEGA
    """Left free for lessons: where less is free, recordings shrink, and in the end rest."""


def budget_of(megabytes: int) -> Budget:
    """A budget of so many MB for all runs."""
    return Budget(megabytes * _MEGA, min(32 * _MEGA, megabytes * _MEGA // 10))


class RunFiles:
    """Everything that is logged in a context goes to these files. All of it may wait for the disk; nothing raises.

    Where the disk fails it is tried again at each `poll`: see Segment for what that costs.
    """

    def __init__(
        self,
        context: Context,
        recordings: Path,
        name: str,
        budget: Budget,
        *,
        describe: Callable[[int], Mapping[str, Mapping[str, str]]],
        attachments: Mapping[str, bytes],
        now_ns: Callable[[], int],
        disk: Disk | None = None,
    ) -> None:
        """`name`: of the run's folder.

        `describe`: metadata of the n-th segment; `attachments`: of the first one, the settings among them
        of each.
        """
        self._context = context
        self._recordings = recordings
        self._name = name
        self._budget = budget
        self._describe = describe
        # What a run began with is needed once more where somebody deletes its folder: it waits for that in little room.
        self._attachments = {name: zlib.compress(data) for name, data in attachments.items()}
        self._now_ns = now_ns
        self._disk = disk or RealDisk()
        self._lock: LockedFolder | None = None
        self._segment: Segment | None = None
        self._number = 0
        self._attached = False
        self.run: Path | None = None
        """The run's folder; None until it could be made."""
        self.trouble = ""
        """Why nothing is kept at the moment, in a line; empty while all is."""
        self.folders = 0
        """That were begun: more than one where somebody has deleted the run meanwhile."""
        self.given_up = 0
        """Segments whose last messages were lost, because the disk failed for too long, or somebody deleted them."""

    @property
    def is_open(self) -> bool:
        """Whether messages that are logged now come to a file."""
        return self._segment is not None

    def take(self, budget: Budget) -> None:
        """Keep to this budget from the next `poll` on; from any thread."""
        self._budget = budget

    def poll(self) -> bool:
        """Once a second: have the disk keep what came, begin files and end them; whether all is kept now."""
        try:
            if self._segment is not None and not self._segment.path.exists():
                self._give_up()  # somebody has deleted it
                self._attached = False
            if self._segment is None:
                return self._begin()
            self._segment.save()
            self._attached = True
            if self._segment.size_bytes >= self._budget.segment_bytes:
                self._end()
                return self._begin()
            return self._check_room()
        except OSError as error:
            self.trouble = f"nothing is recorded ({error}); look at the disk of {self._recordings}"
            if self._segment is not None and self._segment.is_over_limit:
                self._give_up()
            return False

    def close(self) -> bool:
        """End the last file; whether the disk has all of it."""
        try:
            self._end()
        except OSError as error:
            self.trouble = f"the end of the recording is missing ({error}); look at the disk of {self._recordings}"
            return False
        finally:
            self._unlock()
            if self.run is not None:
                with contextlib.suppress(OSError):  # it holds files, or else it is no run
                    self.run.rmdir()
                    self.run = None
        return True

    def _begin(self) -> bool:
        if self.run is not None and not self.run.is_dir():  # somebody has deleted it
            self._unlock()
            self.run, self._attached = None, False
        if not self._has_room():
            return False
        if self.run is None:
            self.run = self._make_folder()
        path = self.run / segment_name(self._number + 1)
        try:
            segment = Segment(path, self._context, self._disk)
        except FileExistsError:
            self._number += 1  # whoever made it, it is kept
            raise
        except OSError:
            with contextlib.suppress(OSError):  # told above; without its name it leaves no riddle
                path.unlink()
            raise
        self._number += 1
        self._segment = segment
        for name, metadata in self._describe(self._number).items():
            segment.describe(name, dict(metadata))
        for attached, data in self._attachments.items():
            if not self._attached or attached in _IN_EACH:
                segment.attach(attached, zlib.decompress(data), self._now_ns())
        segment.save()
        self._attached = True
        self.trouble = ""
        return True

    def _end(self) -> None:
        segment, self._segment = self._segment, None
        if segment is not None:
            segment.close()

    def _give_up(self) -> None:
        segment, self._segment = self._segment, None
        self.given_up += 1
        if segment is not None:
            with contextlib.suppress(OSError):  # `trouble` has told already that this disk fails
                segment.give_up()

    def _check_room(self) -> bool:
        self.trouble = ""
        if self._disk.free_bytes(self._recordings) >= self._budget.reserve_bytes or self._has_room():
            return True
        self._end()
        return False

    def _has_room(self) -> bool:
        """Make room, before a segment is begun for all that will come; `trouble` says why there is none."""
        budget, coming = self._budget, self._budget.segment_bytes if self._segment is None else 0
        spare = self._disk.free_bytes(self._recordings) - budget.reserve_bytes
        make_room(
            self._recordings,
            self.run,
            min(budget.total_bytes, used_bytes(self._recordings) + spare) - coming,
        )
        free = self._disk.free_bytes(self._recordings)
        if free - coming >= budget.reserve_bytes:
            return True
        self.trouble = (
            f"nothing is recorded: {free // _MEGA} MB are free on the disk of {self._recordings}, "
            f"{budget.reserve_bytes // _MEGA} are left for lessons; make room there"
        )
        return False

    def _unlock(self) -> None:
        lock, self._lock = self._lock, None
        if lock is not None:
            lock.close()

    def _make_folder(self) -> Path:
        name = next_run_name(self._name, self._recordings)
        for number in range(1, _MAX_SAME_NAME):
            path = self._recordings / (name if number == 1 else f"{name}-{number}")
            try:
                self._disk.make_folder(path)
            except FileExistsError:  # started twice in a second
                continue
            try:
                self._lock = LockedFolder(path)
            except OSError:
                with contextlib.suppress(OSError):  # an empty folder is no run
                    path.rmdir()
                raise
            self.folders += 1
            return path
        raise FileExistsError(f"{self._recordings / name}: so many runs of this name are there already")
