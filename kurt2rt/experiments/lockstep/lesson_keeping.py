"""Knowledge file during a training run."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from config.errors import UserError
from hal.robot_settings import RobotSettings
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.runtimes import TrainingStore
from kurt2rt.knowledge.journal.loading import OpenedKnowledge, open_for_teaching
from kurt2rt.knowledge.journal.writer import Acknowledgement, JournalWriter, utc_now


class LessonLostError(UserError):
    """Lesson that the robot refused or could not save, which ends a training run."""


class LessonKeeping:
    """Open knowledge file of a training run that checks every acknowledgement."""

    def __init__(
        self, file: Path, opened: OpenedKnowledge, writer: JournalWriter, on_saved: Callable[[Acknowledgement], None]
    ) -> None:
        self.opened = opened
        """Journal and content of the file when it was opened, to continue from."""
        self.writer = writer
        """Event store of the training run (kurt2rt.core.event_store.EventStore)."""
        self._file = file
        self._on_saved = on_saved

    @property
    def training(self) -> TrainingStore:
        """Writer with the knowledge of the file, to teach on from there."""
        opened = self.opened
        return TrainingStore(self.writer, opened.events, opened.counter, opened.saved)

    def check(self) -> None:
        """Pass each new acknowledgement of a durable lesson on. Raises LessonLostError for one that failed."""
        for acknowledgement in self.writer.acknowledged():
            if acknowledgement.error is not None:
                raise LessonLostError(f"{acknowledgement.error}", where=self._file)
            self._on_saved(acknowledgement)

    def telling(
        self, report: Callable[[str, float, float], None], what: str, whole_s: float
    ) -> Callable[[float], None]:
        """Return a callback for the simulated seconds that checks the acknowledgements and reports progress.

        `report` gets `what`, the seconds so far and `whole_s`, in s. The callback raises LessonLostError.
        """

        def on_progress(done_s: float) -> None:
            self.check()
            report(what, done_s, whole_s)

        return on_progress

    def end(self, counted: Statistics) -> None:
        """Store the statistics, and wait until all is durable.

        Raises LessonLostError if a lesson failed or the disk does not answer within 30 s.
        """
        self.writer.submit_statistics(counted)
        if not self.writer.flush(timeout_s=30.0):
            raise LessonLostError(self.writer.saving_error or f"{self._file}: the disk did not answer within 30 s")
        self.check()


@contextmanager
def lessons_kept(
    file: Path,
    settings: RobotSettings,
    task: TaskSettings,
    on_saved: Callable[[Acknowledgement], None] = lambda _: None,
) -> Iterator[LessonKeeping]:
    """Open a knowledge file for a training run, and close it at the end of the context.

    `on_saved` gets the acknowledgement of each durable lesson.

    Raises:
        KnowledgeError: the file cannot be used, or at the end not be written.
        SettingsError: a file that the task uses cannot be read.
    """
    opened = open_for_teaching(file, settings, task)
    with JournalWriter(opened.journal, utc_now) as writer:
        yield LessonKeeping(file, opened, writer, on_saved)
