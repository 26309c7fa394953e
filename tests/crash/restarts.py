"""Lessons on a disk that fails, with the robot program restarted until all are saved."""

from pathlib import Path

from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.journal.writer import Acknowledgement, JournalWriter, RetryDelays
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from tests.crash.lessons_on_disk import taught
from tests.crash.operations import Told
from tests.crash.watched_disk import WatchedDisk
from tests.knowledge.lessons import STAMP, created

SOON = RetryDelays(first_s=0.0005, longest_s=0.001)
LESSONS = range(1, 9)
LONGEST_S = 60.0
"""Ends a test that waits in vain."""


def a_lesson_at_a_time(path: Path, disk: WatchedDisk) -> list[Acknowledgement]:
    """Teach through the writer, as the robot does, with statistics in between; what was acknowledged."""
    acknowledged: list[Acknowledgement] = []
    with taught(path) as journal:
        writer = JournalWriter(journal, now=lambda: STAMP, retry=SOON).start()
        for number in LESSONS:
            writer.submit(created(number))
            writer.submit_statistics(Statistics({1: number}, {(1, 2): number}))
            assert writer.flush(LONGEST_S), writer.saving_error
            assert writer.saving_error is None
            acknowledged += writer.acknowledged()
            disk.note(Told(number))
        writer.close()
    return acknowledged


def with_patience(path: Path, disk: WatchedDisk) -> tuple[list[Acknowledgement], list[str]]:
    """Restart until the disk accepts all lessons; return the acknowledgements and the texts of the refusals."""
    refused: list[str] = []
    acknowledged: list[Acknowledgement] = []
    while True:
        failed = len(disk.failed)
        try:
            acknowledged += a_lesson_at_a_time(path, disk)
        except KnowledgeError as error:
            refused.append(str(error))
            assert len(disk.failed) > failed, "refused without a reason"
        else:
            return acknowledged, refused
