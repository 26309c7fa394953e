"""A robot that is taught without end: the child of test_kill.py, which kills it.

Prints the number of each lesson as soon as it is acknowledged.
"""

import os
import sys
from itertools import count
from pathlib import Path

from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.writer import JournalWriter, utc_now
from tests.knowledge.lessons import BINDING, created


def teach(path: Path, lessons_at_once: int) -> None:
    """Teach on from the last lesson in the file, several lessons before the first of them is acknowledged."""
    journal = Journal.open(path, BINDING)
    taught = len(journal.events())
    with JournalWriter(journal, utc_now) as writer:
        for first in count(taught + 1, lessons_at_once):
            for number in range(first, first + lessons_at_once):
                writer.submit(created(number))
            writer.submit_statistics(Statistics(dict.fromkeys(range(1, 9), first), {(1, 2): first}))
            waiting = lessons_at_once
            while waiting:
                writer.flush(timeout_s=0.001)
                for acknowledgement in writer.acknowledged():
                    os.write(1, f"{acknowledgement.command_id} {acknowledgement.sequence}\n".encode())
                    waiting -= 1


if __name__ == "__main__":
    teach(Path(sys.argv[1]), int(sys.argv[2]))
