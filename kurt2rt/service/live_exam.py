"""Exam of a running robot's knowledge, driven by another process at a lower priority."""

import hashlib
import json
import subprocess
import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Self

from kurt2rt.channel.protocol.simulation import EXAM, NO_EXAM, ExamStatus
from kurt2rt.core.message_fields import WireError
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.platform.durable_files import write_durably

Command = Callable[[Path, Path], Sequence[str]]
"""Returns the words that start an exam of a knowledge file, with the path of its picture."""


def verdict_file(knowledge: Path) -> Path | None:
    """Return the file of the newest verdict on knowledge, by its first lesson: a copy has it, too, a new file does not.

    None for a file without a lesson. Raises KnowledgeError.
    """
    with Journal.in_writer_process(knowledge) as journal:
        first = next(journal.iter_entries(), None)
    if first is None:
        return None
    name = hashlib.sha256(first.event.origin.command_id.encode()).hexdigest()[:16]
    return knowledge.with_name("exams") / f"verdict-{name}.json"


class LiveExam:
    """Exam of a running robot's knowledge in a process of its own, one at a time, and its status.

    A thread reads the status that the process prints as lines of JSON (`exam_status.EXAM`).
    """

    def __init__(self, command: Command, taught: Path) -> None:
        """Start with the verdict of an earlier run on the same knowledge file.

        Args:
            command: its process ends by itself as soon as its standard input does.
            taught: knowledge file, which may be made later.
        """
        self._command = command
        self._process: subprocess.Popen[bytes] | None = None
        self._reading: threading.Thread | None = None
        self._lock = threading.Lock()
        self._closed = False
        self._taught = taught
        self.status = NO_EXAM
        """Status, replaced by the thread that reads."""
        self.picture: Path | None = None
        """Picture of the newest exam, drawn once it has a verdict; None before the first exam."""
        with suppress(OSError, KnowledgeError, WireError, ValueError):
            verdict = verdict_file(taught)
            if verdict is not None:
                self.status = EXAM.read(json.loads(verdict.read_text(encoding="utf-8")))
                self.picture = verdict.with_name(self.status.picture)

    def begin(self, knowledge: Path, picture: Path) -> None:
        """Start an exam of a copy of the knowledge, deleted at the end; `picture` is the file to draw.

        Raises KnowledgeError while one runs, and if its process cannot be started.
        """
        with self._lock:
            if self._closed or self.status.running:
                knowledge.unlink(missing_ok=True)
                raise KnowledgeError(KnowledgeCode.EXAM_RUNS)
            try:
                self._process = subprocess.Popen(
                    self._command(knowledge, picture),
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    start_new_session=True,
                )
            except OSError as error:
                knowledge.unlink(missing_ok=True)
                raise KnowledgeError(KnowledgeCode.EXAM_NOT_STARTED, error=error) from error
            self.status, self.picture = ExamStatus(True, 0.0, "the exam begins"), picture
            self._reading = threading.Thread(
                target=self._read, args=(self._process, knowledge, picture), name="exam", daemon=True
            )
            self._reading.start()

    def close(self) -> None:
        """End the exam that runs, without a verdict."""
        with self._lock:
            self._closed = True
            process, reading = self._process, self._reading
        if process is not None and process.poll() is None:
            process.kill()
        if reading is not None:
            reading.join()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _read(self, process: "subprocess.Popen[bytes]", knowledge: Path, picture: Path) -> None:
        assert process.stdout is not None
        assert process.stdin is not None
        verdict: ExamStatus | None = None
        try:
            for line in process.stdout:
                with suppress(WireError, ValueError):  # a line that a library printed
                    status = EXAM.read(json.loads(line))
                    if status.running:
                        self.status = status
                    else:
                        verdict = status
            code = process.wait()
        finally:
            process.stdin.close()
            process.stdout.close()
            knowledge.unlink(missing_ok=True)
        # Verdict and picture together: pages do not ask again after the exam.
        if verdict is None:
            trouble = f"the exam ended without a verdict (code {code}); examine again"
            self.status = replace(self.status, running=False, trouble=trouble)
        elif verdict.trouble:
            self.status = verdict
        else:
            verdict = replace(verdict, picture=picture.name if picture.is_file() else "")
            with suppress(OSError, KnowledgeError):  # it is told all the same
                if (kept := verdict_file(self._taught)) is not None:
                    write_durably(kept, json.dumps(EXAM.plain_of(verdict)))
            self.status = verdict
