"""Segments of the current run, within a budget, on a disk that may fail."""

import contextlib
import zlib
from pathlib import Path

from foxglove import Context

from hal import points
from kurt2rt.knowledge.exchange.attachments import ROBOT, TASK
from kurt2rt.runs.recording.recording_disk import Disk, LockedFolder, RealDisk
from kurt2rt.runs.recording.run_folder import MEGA, Budget, make_room, next_run_name, segment_name, used_bytes
from kurt2rt.runs.recording.run_head import RecordedRun
from kurt2rt.runs.recording.segment import Segment

_MAX_SAME_NAME = 1000
_IN_EACH = (ROBOT, TASK)
"""Attachments of every segment: a segment stays readable after older ones were deleted."""


class RunFiles:
    """Segment files of one run, which get all that is logged in a context, within the budget of disk space.

    Calls may block on the disk and never raise. After an error each `poll` tries again; Segment states the cost.
    """

    def __init__(
        self,
        context: Context,
        recordings: Path,
        run: RecordedRun,
        budget: Budget,
        disk: Disk | None = None,
    ) -> None:
        self._context = context
        self._recordings = recordings
        self._run = run
        self._budget = budget
        # Kept compressed: the attachments are written again if a user deletes the run folder.
        self._attachments = {name: zlib.compress(data) for name, data in run.attachments.items()}
        self._disk = disk or RealDisk()
        self._lock: LockedFolder | None = None
        self._segment: Segment | None = None
        self._number = 0
        self._attached = False
        self.run: Path | None = None
        """Run folder; None until it was created."""
        self.trouble = ""
        """Reason why nothing is recorded at the moment, in one line; empty otherwise."""
        self.folders = 0
        """Folders created so far: more than one if a user deleted the run meanwhile."""
        self.given_up = 0
        """Segments whose last messages were lost: the disk failed too long, or a user deleted them."""

    @property
    def is_open(self) -> bool:
        """Return whether messages logged now go to a file."""
        return self._segment is not None

    def poll(self) -> bool:
        """Sync, start and end segments; return whether everything is durable. Call it once a second."""
        try:
            if self._segment is not None and not self._segment.path.exists():
                self._give_up()  # a user deleted it
                self._attached = False
            if self._segment is None:
                return self._begin()
            self._segment.save()
            self._attached = True
            is_full = self._segment.size_bytes >= self._budget.segment_bytes
            if is_full or points.happens("a segment ends early"):
                self._end()
                return self._begin()
            return self._check_room()
        except OSError as error:
            self.trouble = f"nothing is recorded ({error}); look at the disk of {self._recordings}"
            if self._segment is not None and self._segment.is_over_limit:
                self._give_up()
            return False

    def close(self) -> bool:
        """Close the last segment; return whether all of it is durable."""
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
        if self.run is not None and not self.run.is_dir():  # a user deleted it
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
            self._number += 1  # the file of another program is kept
            raise
        except OSError:
            with contextlib.suppress(OSError):  # told above; without its name it leaves no riddle
                path.unlink()
            raise
        self._number += 1
        self._segment = segment
        for name, metadata in self._run.metadata(self._number).items():
            segment.describe(name, metadata)
        for attached, data in self._attachments.items():
            if not self._attached or attached in _IN_EACH:
                segment.attach(attached, zlib.decompress(data), self._run.now_ns())
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
        """Delete older runs for the next segment; return whether it fits, else set `trouble`."""
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
            f"nothing is recorded: {free // MEGA} MB are free on the disk of {self._recordings}, "
            f"{budget.reserve_bytes // MEGA} are left for lessons; make room there"
        )
        return False

    def _unlock(self) -> None:
        lock, self._lock = self._lock, None
        if lock is not None:
            lock.close()

    def _make_folder(self) -> Path:
        name = next_run_name(self._run.name, self._recordings)
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
        raise FileExistsError(f"{self._recordings / name}: too many runs have this name already")
