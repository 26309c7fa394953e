"""A robot that is taught a little, with a kernel that fails it: the child of test_failing_calls.py.

Prints the row of each lesson as soon as it is acknowledged, and in the end what was wrong.
"""

import os
import sys
from pathlib import Path

from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.writer import JournalWriter, RetryDelays, utc_now
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from tests.knowledge.lessons import BINDING, created

LESSONS = 4
LONGEST_S = 20.0
REFUSED = 3
"""Exit code where the journal says why it does not open, or close."""


def teach(path: Path) -> None:
    """Teach the lessons that are not there yet, one after the other."""
    journal = Journal.open(path, BINDING)
    first = len(journal.events()) + 1
    with JournalWriter(journal, utc_now, RetryDelays(0.001, 0.002)) as writer:
        for number in range(first, LESSONS + 1):
            writer.submit(created(number))
            writer.submit_statistics(Statistics({1: number}, {(1, 2): number}))
            if not writer.flush(LONGEST_S):
                raise KnowledgeError(KnowledgeCode.NOT_DURABLE, reason=writer.saving_error)
            for acknowledgement in writer.acknowledged():
                os.write(1, f"row {acknowledgement.sequence} {acknowledgement.command_id}\n".encode())


if __name__ == "__main__":
    try:
        teach(Path(sys.argv[1]))
    except KnowledgeError as error:
        os.write(1, f"refused: {error}\n".encode())
        sys.exit(REFUSED)
