"""A person teaches from the terminal that `kurt2rt run` runs in: one line, one command."""

import queue
import threading
from collections.abc import Callable, Sequence
from typing import TextIO

from kurt2rt.rla.rla import Phase
from kurt2rt.teaching.commands import Command, Correct, DeleteRla, ReplaceAction, Resume, SetPhase, Stop, Teach
from kurt2rt.tick import TickRecord

_TEACHER = "terminal"


class TerminalTeacher:
    """Reads lines in a thread of its own; `watch` hands each to the next tick as a command."""

    def __init__(self, lines: TextIO, actions: Sequence[str], say: Callable[[str], None], *, session: str) -> None:
        """`session` begins the ids of all commands and must differ between runs on the same knowledge."""
        self._lines = lines
        self._actions = tuple(actions)
        self._say = say
        self._session = session
        self._said = 0
        self._typed: queue.SimpleQueue[str] = queue.SimpleQueue()
        # Daemon: reading a terminal cannot be interrupted, and must not keep the process alive.
        self._thread = threading.Thread(target=self._read, name="terminal", daemon=True)

    @property
    def help(self) -> str:
        """What can be typed."""
        return (
            "type an action to answer or correct, or: stop, resume, delete N, replace N ACTION, phase 1 or 2, help\n"
            f"actions: {', '.join(self._actions)}"
        )

    def start(self) -> None:
        """Begin to read."""
        self._thread.start()

    def watch(self, record: TickRecord) -> Command | None:
        """The command that was typed next, if any; what became of earlier ones is said."""
        for result in record.results:
            self._say(("" if result.accepted else "refused: ") + result.text)
        try:
            line = self._typed.get_nowait()
        except queue.Empty:
            return None
        command = self._understand(line, asking=record.decision.asking)
        if command is None:
            self._say(self.help)
        return command

    def _read(self) -> None:
        for line in self._lines:
            if line.strip():
                self._typed.put(line)

    def _understand(self, line: str, *, asking: bool) -> Command | None:
        self._said += 1
        command_id = f"{self._session}-{self._said}"
        match line.lower().split():
            case ["stop"]:
                return Stop(command_id, _TEACHER)
            case ["resume"]:
                return Resume(command_id, _TEACHER)
            case ["delete", rla_id] if rla_id.isdecimal():
                return DeleteRla(command_id, _TEACHER, int(rla_id))
            case ["replace", rla_id, action] if rla_id.isdecimal():
                return ReplaceAction(command_id, _TEACHER, int(rla_id), action)
            case ["phase", "1"]:
                return SetPhase(command_id, _TEACHER, Phase.SUPERVISED)
            case ["phase", "2"]:
                return SetPhase(command_id, _TEACHER, Phase.CORRECTIONS)
            case [action] if action in self._actions:
                # The same word answers a question and corrects a robot that drives.
                return Teach(command_id, _TEACHER, action) if asking else Correct(command_id, _TEACHER, action)
        return None
