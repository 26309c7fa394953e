"""Late presses: a person's correction is about the decision that it reacts to, not about the present one."""

from dataclasses import replace

from kurt2rt.core.outcome import Field, Outcome
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.core.teaching.commands import Command, Correct
from kurt2rt.core.teaching.teacher_delay import TeacherDelay


class LatePresses:
    """Assignment of presses to decisions by the delay of their teachers."""

    def __init__(self, recent: DecisionHistory, delay: TeacherDelay) -> None:
        self._recent = recent
        self._delay = delay

    def assign(self, command: Command, speed: int) -> Command:
        """Return a late press with the tick of the decision that it reacts to, and any other command unchanged.

        Args:
            command: a press is late if it is a correction of the basic level with `late`.
            speed: robot seconds in one second.
        """
        if not isinstance(command, Correct) or not _is_late(command) or self._recent.newest < 0:
            return command
        seen = command.seen_tick if command.decision_tick is None else command.decision_tick
        given = self._recent.newest if seen is None else min(seen, self._recent.newest)
        back_ticks = self._delay.correction_ticks(command.teacher, speed)
        return replace(command, seen_tick=given, decision_tick=self._decision(given, back_ticks))

    def described(self, command: Command, outcome: Outcome) -> Outcome:
        """Return the outcome of a late press with the tick and RLA that it was given to, and how it was found.

        `command`: as `assign` returned it. The outcome of any other command is returned unchanged.
        """
        if not isinstance(command, Correct) or not _is_late(command):
            return outcome
        meant, given = command.decision_tick, command.seen_tick
        if meant is None or given is None or not self._recent.contains(meant):
            return outcome
        fields: dict[str, Field] = {
            "decision_tick": meant,
            "put_back_ticks": max(0, given - meant),
            "decided_by": self._recent.driving_rla(meant),
            "delay_answers": self._delay.answers(command.teacher),
        }
        return Outcome(outcome.code, {**outcome.fields, **fields})

    def _decision(self, given: int, back_ticks: int) -> int:
        """Return the first tick from `back_ticks` before `given` on in which an RLA or another learner drove.

        If none drove in `given`, the robot stood there and the press is about that situation. If the robot asked
        meanwhile and drove on by itself, the press answers that question.
        """
        recent, asked = self._recent, self._delay.last_asked_tick
        if recent.contains(given) and recent.drove(given):
            if asked is not None and given - back_ticks <= asked < given and recent.contains(asked):
                return asked
            for tick in range(max(0, given - back_ticks), given):
                if recent.contains(tick) and recent.drove(tick) and recent.has_situation(tick):
                    return tick
        return given


def _is_late(command: Correct) -> bool:
    return command.late and command.level == BASIC
