"""Knowledge file during a training run."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from hal.errors import UserError
from hal.robot_settings import RobotSettings
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.runtimes import TrainingStore
from kurt2rt.knowledge.journal.loading import OpenedKnowledge, open_for_teaching
from kurt2rt.knowledge.journal.writer import Acknowledgement, JournalWriter, utc_now


class LessonLostError(UserError):
    """Lessons could not be saved, or were refused."""


class LessonKeeping:
    """Open knowledge file of a training run that checks every acknowledgement."""

    def __init__(
        self, file: Path, opened: OpenedKnowledge, writer: JournalWriter, on_saved: Callable[[Acknowledgement], None]
    ) -> None:
        self.opened = opened
        """What the file held when it was opened, to go on from."""
        self.writer = writer
        """Event store of the training run (kurt2rt.core.tick.EventStore)."""
        self._file = file
        self._on_saved = on_saved

    @property
    def training(self) -> TrainingStore:
        """Return the writer with the knowledge of the file, to teach on from there."""
        opened = self.opened
        return TrainingStore(self.writer, opened.events, opened.counter, opened.saved)

    def look(self) -> None:
        """Check the acknowledgements so far. Raises LessonLostError."""
        for acknowledgement in self.writer.acknowledged():
            if acknowledgement.error is not None:
                raise LessonLostError(f"{acknowledgement.error}", where=self._file)
            self._on_saved(acknowledgement)

    def telling(
        self, report: Callable[[str, float, float], None], what: str, whole_s: float
    ) -> Callable[[float], None]:
        """Return a callback for the simulated seconds that checks the acknowledgements and reports progress."""

        def on_progress(done_s: float) -> None:
            self.look()
            report(what, done_s, whole_s)

        return on_progress

    def end(self, counted: Statistics) -> None:
        """Store the statistics, and wait until all is durable. Raises LessonLostError."""
        self.writer.submit_statistics(counted)
        if not self.writer.flush(timeout_s=30.0):
            raise LessonLostError(self.writer.saving_error or f"{self._file}: the disk did not answer within 30 s")
        self.look()


@contextmanager
def lessons_kept(
    file: Path,
    settings: RobotSettings,
    task: TaskSettings,
    on_saved: Callable[[Acknowledgement], None] = lambda _: None,
) -> Iterator[LessonKeeping]:
    """Go on teaching into a file. `on_saved` hears of each lesson once it is durable. Raises KnowledgeError."""
    opened = open_for_teaching(file, settings, task)
    with JournalWriter(opened.journal, utc_now) as writer:
        yield LessonKeeping(file, opened, writer, on_saved)
