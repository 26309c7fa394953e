"""Presses about an earlier moment: a late one is about what its teacher saw, a rewind about what they look back to."""

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from kurt2rt.core.outcome import Field, Outcome
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.core.teaching.commands import Command, Correct

BACK_TICKS = 200
"""Longest time by which a press is put back, in ticks of real time: 2 s."""
DEFAULT_TICKS = 100
"""Delay of a teacher without enough answers, in ticks of real time."""
HAND_PART = 4
"""A hand that follows the robot is faster than an answer by this factor, because nothing has to be decided again.

Chosen on wall following, seeds 900 and 901, by an ordinary person with a hand of 0.3 s who answers after 1.25 s:
held lessons put back by 0, 0.3, 0.6 and 1.25 s passed 0 of 6, 4 of 6, 3 of 6 and 0 of 3 exams.
"""
CORRECTION_PART = 0.6
"""Delay of a correction from the moment in which its mistake was noticed, as a fraction of that of an answer.

A person who watches and sees a mistake knows the right action already. Chosen by the tests on search seeds that
docs/notebook.md names.
"""
_WINDOW = 16
_LEAST_ANSWERS = 4
_LONGEST_TICKS = 500
"""A later answer tells nothing about the delay: its teacher looked elsewhere, or thought about it."""


class TeacherDelay:
    """Time from a situation to a teacher's press about it: the median of their last 16 answers, in ticks of real time.

    It dates presses that name no moment, such as a late correction (3/4 of it) or a held action (1/4 of it).

    A question counts from its first tick; an answer from the newest state that its teacher had, so that the link's
    delay is left out.
    """

    def __init__(self, default_ticks: int = DEFAULT_TICKS, saved: Mapping[str, Sequence[int]] | None = None) -> None:
        """Begin with the answers of earlier runs.

        Args:
            default_ticks: delay of a teacher who has given fewer than four answers.
            saved: result of `snapshot`, whose impossible times are left out. None: no answers.
        """
        self._default_ticks = default_ticks
        self._answers: dict[str, deque[int]] = {
            teacher: deque((each for each in took if 0 <= each <= _LONGEST_TICKS), maxlen=_WINDOW)
            for teacher, took in (saved or {}).items()
        }
        self.asked_tick: int | None = None
        """First tick of the present question; None if the robot does not ask."""
        self.last_asked_tick: int | None = None
        """Newest tick of the last question, also if it ended by itself; None once a lesson was given after it, or the
        robot was set down elsewhere."""
        self._answered = False

    def on_decision(self, tick: int, *, asks: bool, present: bool = True) -> None:
        """Note whether the robot asked (`asks`) in a tick; call it on every tick.

        `present`: whether its teacher was there; an answer tells no delay if its teacher came after the question.
        """
        if not asks:
            self.asked_tick = None
            return
        if self.asked_tick is None:
            self.asked_tick, self._answered = tick, not present
        self.last_asked_tick = tick

    def on_answer(self, teacher: str, given_tick: int, speed: int) -> None:
        """Note an answer that its teacher gave on the state of `given_tick`; only the first to a question counts.

        Args:
            teacher: who answered.
            given_tick: newest state that the teacher had.
            speed: robot seconds in one second.
        """
        if self.asked_tick is None or self._answered or given_tick < self.asked_tick:
            return
        self._answered = True
        took = (given_tick - self.asked_tick) // speed
        if took <= _LONGEST_TICKS:
            self._answers.setdefault(teacher, deque(maxlen=_WINDOW)).append(took)

    def snapshot(self) -> dict[str, tuple[int, ...]]:
        """Return the times of the last answers by teacher, oldest first, in ticks of real time, to be saved."""
        return {teacher: tuple(took) for teacher, took in self._answers.items()}

    def answers(self, teacher: str) -> int:
        """Return the number of answers that the delay of a teacher is computed from; 0 while it is the default."""
        count = len(self._answers.get(teacher, ()))
        return count if count >= _LEAST_ANSWERS else 0

    def hand_ticks(self, teacher: str, speed: int) -> int:
        """Return the delay of a teacher's hand that follows the robot while holding, in ticks of the robot.

        `speed`: robot seconds in one second.
        """
        return self.ticks(teacher, speed) // HAND_PART

    def correction_ticks(self, teacher: str, speed: int) -> int:
        """Return the delay of a teacher's correction, in ticks of the robot.

        `speed`: robot seconds in one second.
        """
        return round(self.ticks(teacher, speed) * CORRECTION_PART)

    def ticks(self, teacher: str, speed: int) -> int:
        """Return the delay of a teacher's answer in ticks of the robot, at most BACK_TICKS of real time.

        `speed`: robot seconds in one second.
        """
        answers = sorted(self._answers.get(teacher, ()))
        delay = answers[len(answers) // 2] if len(answers) >= _LEAST_ANSWERS else self._default_ticks
        return min(delay, BACK_TICKS) * speed


class LatePresses:
    """Assignment of corrections to the decision that the teacher reacted to (credit assignment).

    With the teacher's delay d, a press on the state of tick t is about the first tick from t - 3/4 d on in which an
    RLA drove. If the robot stood in t, the press is about t. The tick calls `assign` before the lesson is built.
    """

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


DRIVEN_TICKS = 6200
"""Ticks of driving that are kept: the minute that the page offers, and what the robot drives until it stands."""
CHUNK_TICKS = 100
"""Ticks of driving that are copied at once."""


class _Stretch(NamedTuple):
    """Ticks in a row in which a wheel turned."""

    first: int
    end: int
    """Tick after the last one."""
    number: int
    """Number of the first of them, counted over all ticks of driving."""


class RewindHistory:
    """Decisions of the last 62 s of driving, however long the robot stood since, for a teacher who looks back.

    `Correct` with one of these ticks corrects that moment (rewind on the page).

    The history of recent decisions continues at standstill, so a teacher who thinks, and a robot that moves for
    moments only, would lose the drive. Memory is constant.
    """

    def __init__(self, recent: DecisionHistory) -> None:
        """Copy from `recent`, which the tick continues to write."""
        self._recent = recent
        self._kept = recent.empty_copy(DRIVEN_TICKS)
        self._stretches: deque[_Stretch] = deque()
        self._driven = 0
        """Ticks of driving up to the present stretch."""
        self._first: int | None = None
        """First tick of the present stretch that was not copied; None at standstill."""
        self.driving = False
        """Whether a wheel turned at the last update."""

    def update(self, *, driving: bool) -> None:
        """Follow the newest recent tick, in which a wheel turned if `driving`.

        Call it when that changes, and each CHUNK_TICKS ticks unless the recent history keeps all ticks.
        """
        self.driving, newest = driving, self._recent.newest
        if self._first is not None and newest > self._first:
            self._keep(self._first, newest)
        self._first = newest if driving else None

    def find(self, tick: int) -> tuple[DecisionHistory, int] | None:
        """Return the history that stores a tick, and the number by which it is read there; None if none does."""
        if self._recent.contains(tick):
            return self._recent, tick
        stretches = [*self._stretches]
        if self._first is not None:
            stretches.append(_Stretch(self._first, self._recent.newest + 1, self._driven))
        for stretch in reversed(stretches):
            if stretch.first <= tick < stretch.end:
                newest = stretches[-1].number + stretches[-1].end - stretches[-1].first
                number = stretch.number + tick - stretch.first
                read = self._kept.number_of(tick, number) if newest - number <= DRIVEN_TICKS else None
                return None if read is None else (self._kept, read)
        return None

    def _keep(self, first: int, end: int) -> None:
        """Copy the ticks of driving from `first` to before `end`, and forget the oldest ones."""
        self._kept.copy_ticks(self._recent, first, end - first, self._driven)
        self._stretches.append(_Stretch(first, end, self._driven))
        self._driven += end - first
        while self._driven - (oldest := self._stretches[0]).number - (oldest.end - oldest.first) > DRIVEN_TICKS:
            self._stretches.popleft()
