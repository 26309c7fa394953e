"""A scripted teacher of all phases: answers and corrects as ever, praises and blames, and teaches the critic."""

import random
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from behaviors.judges.judge import Judge
from kurt2rt.core.decision.decision import Cause
from kurt2rt.core.rla.rla import BASIC, Phase
from kurt2rt.core.teaching.commands import Appraise, Command, Resume, Reward, RunBehaviour
from kurt2rt.core.tick import TickRecord
from kurt2rt.teacher.scripted.teacher import ScriptedTeacher, picture_of

_NAME = "scripted teacher"


@dataclass(frozen=True, slots=True)
class FeedbackTiming:
    """How the teacher gives signals, in ticks."""

    reaction: int
    """From the picture that he means to the signal."""
    every: Mapping[int, int]
    """The shortest time from one signal to the next of the same value, by value; neutral ones teach the critic only."""
    gap: int = 0
    """The shortest time between two signals of any value."""
    most_blame: int = 0
    """He blames no more often than this; 0: as often as he likes."""


class RewardSource(Protocol):
    """What a teacher has to say of what he sees."""

    def look(self, record: TickRecord) -> tuple[int, int] | None:
        """Value of a signal and the tick that it is about; None: nothing. To be asked in every tick."""
        ...


class JudgeReward:
    """Says of every picture what a judge thinks of it, while something drives the robot."""

    def __init__(self, judge: Judge, patience: int = 0) -> None:
        """`patience`: ticks for which it must have been bad without a break before anything is said of it."""
        self._judge = judge
        self._patience = patience
        self._bad = 0

    def look(self, record: TickRecord) -> tuple[int, int] | None:
        """Of this tick."""
        if record.circumstances is None or not record.decision.driving:
            self._bad = 0
            return None
        value = self._judge.judge(record.circumstances)
        self._bad = self._bad + 1 if value < 0 else 0
        return None if 0 < self._bad < self._patience else (value, record.tick)


class UnknownPenalty:
    """Knows only that to be in an unknown situation is bad: blames what led there."""

    def __init__(self) -> None:
        self._drove = False

    def look(self, record: TickRecord) -> tuple[int, int] | None:
        """Of the tick before the robot began to ask."""
        drove, self._drove = self._drove, record.decision.driving
        asking = record.decision.cause is Cause.UNKNOWN and record.decision.asks_at == BASIC
        return (-1, record.tick - 1) if asking and drove else None


class RandomPenalty:
    """Blames whatever drives, so many times: what a teacher does to whom it does not matter what he sees."""

    def __init__(self, times: int, ticks: int, gap: int, seed: int) -> None:
        """`times` in so many ticks, spread by chance; a blame waits until an RLA drives, and for `gap` ticks."""
        chance = random.Random(f"blame by chance, seed {seed}")
        self._due = deque(sorted(chance.randrange(1, max(ticks, 1) + 1) for _ in range(times)))
        self._gap = gap
        self._next_tick = 0

    def look(self, record: TickRecord) -> tuple[int, int] | None:
        """Of this tick."""
        due = bool(self._due) and self._due[0] <= record.tick >= self._next_tick
        if not due or not record.decision.driving or record.decision.rla_id is None:
            return None
        self._due.popleft()
        self._next_tick = record.tick + self._gap
        return -1, record.tick


class _Said(NamedTuple):
    due_tick: int
    command: Command


class ScriptedAppraiser:
    """In phases 1 and 2 a ScriptedTeacher; in 3 and 4 that one only answers, and signals are given besides; 5: silent.

    Signals are rewards in phase 3, of what an RLA drove; in phase 4 they teach the critic, neutral ones among them.
    """

    def __init__(
        self,
        answering: ScriptedTeacher,
        habits: FeedbackTiming,
        signs: RewardSource | None,
        appraisals: Mapping[int, str],
        *,
        session: str,
        seed: int = 0,
        shown: Sequence[str] = (),
    ) -> None:
        """`signs`: None where he has none to give. `appraisals`: name of the critic's opinion of each value.

        `session`: as in ScriptedTeacher. `shown`: actions of which one, by chance, drives where the robot was set down
        in phase 4, so that the critic sees what the robot does not do by itself.
        """
        self._answering = answering
        self._habits = habits
        self._signs = signs
        self._appraisals = appraisals
        self._session = session
        self._chance = random.Random(f"what is shown to the critic in {session}, seed {seed}")
        self._shown = tuple(shown)
        self._said = self._blamed = 0
        self._next_tick: dict[int, int] = {}
        self._next_any = 0
        self._waiting: deque[_Said] = deque()
        self._resume_at: int | None = None
        self.phase = answering.phase

    def enter(self, phase: Phase) -> Command:
        """Begin a phase: what to tell the robot."""
        self.phase = phase
        command = self._answering.enter(phase)
        if phase is not Phase.CORRECTIONS:  # what was wrong is said by signals, or by nobody
            self._answering.phase = Phase.SUPERVISED
        return command

    def only_answer(self) -> None:
        """Until the next phase begins nothing is corrected."""
        self._answering.phase = Phase.SUPERVISED

    def pursue(self, behaviour: str) -> Command:
        """Another taught behaviour is wanted: what to tell the robot."""
        return self._answering.pursue(behaviour)

    def go(self) -> Command:
        """The robot shall drive again after an alarm: what to tell it."""
        return self._answering.go()

    def is_signal(self, command_id: str) -> bool:
        """Whether it is a signal's id: one that comes too late, when its RLA is gone, may be refused."""
        return command_id.startswith(f"{self._session}-signal-")

    @property
    def answers(self) -> bool:
        """Whether he is there to be asked."""
        return self.phase is not Phase.AUTONOMOUS

    def show(self, tick: int, ticks: int, share: float = 1.0) -> list[Command]:
        """The robot was just set down: some action drives it for so long, or, but for a share of the times, none."""
        if not self._shown or not ticks or self._chance.random() >= share:
            return []
        self._resume_at = tick + ticks + 1
        return [RunBehaviour(self._next_id("shown"), _NAME, self._chance.choice(self._shown), ticks)]

    def watch(self, record: TickRecord) -> list[Command]:
        """See one tick; all that he says to it."""
        if self.phase is Phase.AUTONOMOUS:
            return []
        said: list[Command] = []
        if self._resume_at is not None and record.tick >= self._resume_at:
            self._resume_at = None
            said.append(Resume(self._next_id("shown"), _NAME))
        answer = self._answering.watch(picture_of(record))
        if answer is not None:
            said.append(answer)
        if self.phase in (Phase.REINFORCEMENT, Phase.CRITIC) and self._signs is not None:
            self._look(record, self._signs)
        while self._waiting and self._waiting[0].due_tick <= record.tick:
            said.append(self._waiting.popleft().command)
        return said

    def _look(self, record: TickRecord, signs: RewardSource) -> None:
        seen = signs.look(record)
        if seen is None:
            return
        value, tick = seen
        if record.tick < max(self._next_tick.get(value, 0), self._next_any):
            return
        command = (
            self._reward(value, tick, record) if self.phase is Phase.REINFORCEMENT else self._appraise(value, tick)
        )
        if command is not None:
            self._next_tick[value] = record.tick + self._habits.every[value]
            self._next_any = record.tick + self._habits.gap
            self._waiting.append(_Said(record.tick + self._habits.reaction, command))

    def _reward(self, value: int, tick: int, record: TickRecord) -> Command | None:
        by_rla = record.decision.rla_id is not None or tick < record.tick
        if value == 0 or not by_rla:
            return None
        if value < 0:
            if self._habits.most_blame and self._blamed >= self._habits.most_blame:
                return None
            self._blamed += 1
        return Reward(self._next_id(), _NAME, value, tick)

    def _appraise(self, value: int, tick: int) -> Command | None:
        name = self._appraisals.get(value)
        return None if name is None else Appraise(self._next_id(), _NAME, name, tick)

    def _next_id(self, what: str = "signal") -> str:
        self._said += 1
        return f"{self._session}-{what}-{self._said}"
