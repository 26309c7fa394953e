"""Scripted teacher of all phases: it answers and corrects, gives rewards, and teaches the critic."""

import random
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from behaviors.judges.judge import Judge
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.rla.rla import BASIC, Phase
from kurt2rt.core.teaching.commands import Appraise, Command, Resume, Reward, RunBehaviour
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.teacher.scripted.basic_teacher import Ahead, BasicTeacher, TeacherView, view_of_tick
from kurt2rt.teacher.scripted.press_times import HumanTimes, PressTimes

_NAME = "scripted teacher"


@dataclass(frozen=True, slots=True)
class FeedbackTiming:
    """Delay and shortest intervals, in ticks, of a scripted teacher's rewards and appraisals."""

    reaction: int
    """Delay of a signal after the judged tick."""
    every: Mapping[int, int]
    """Shortest time between two signals of the same value, by value; signals of value 0 teach the critic only."""
    gap: int = 0
    """Shortest time between two signals of any value."""
    max_punishments: int = 0
    """Limit on rewards of -1; 0: no limit."""


class RewardSource(Protocol):
    """Source of a scripted teacher's rewards and appraisals, such as a judge."""

    def on_tick(self, record: TickRecord) -> tuple[int, int] | None:
        """Return the value, -1, 0 or +1, and the tick of a signal; None without one. Call this on every tick."""
        ...


class JudgeReward:
    """Reward source that asks a judge in each tick in which the robot drives."""

    def __init__(self, judge: Judge, patience: int = 0) -> None:
        """Set the judge; `patience` is the number of bad ticks in a row before -1 is given, 0 or 1: at once."""
        self._judge = judge
        self._patience = patience
        self._bad = 0

    def on_tick(self, record: TickRecord) -> tuple[int, int] | None:
        """Return the judge's value, -1, 0 or +1, and this tick; None if there is no signal.

        There is none while no action drives, and while a value of -1 has not lasted for the patience. Call this on
        every tick.
        """
        if record.appraisal_features is None or not record.decision.driving:
            self._bad = 0
            return None
        value = self._judge.judge(record.appraisal_features)
        self._bad = self._bad + 1 if value < 0 else 0
        return None if 0 < self._bad < self._patience else (value, record.tick)


class UnknownPenalty:
    """Reward of -1 for the tick that led into an unknown situation."""

    def __init__(self) -> None:
        self._drove = False

    def on_tick(self, record: TickRecord) -> tuple[int, int] | None:
        """Return -1 and the tick before this one, if the robot drove there and asks now; otherwise None.

        Call this on every tick.
        """
        drove, self._drove = self._drove, record.decision.driving
        asking = record.decision.cause is DecisionCause.UNKNOWN and record.decision.asks_at == BASIC
        return (-1, record.tick - 1) if asking and drove else None


class RandomPenalty:
    """Rewards of -1 at random ticks: the control condition of a teacher who does not look."""

    def __init__(self, times: int, ticks: int, gap: int, seed: int) -> None:
        """Spread `times` rewards over `ticks`; each waits until an RLA drives and `gap` ticks have passed."""
        chance = random.Random(f"blame by chance, seed {seed}")
        self._due = deque(sorted(chance.randrange(1, max(ticks, 1) + 1) for _ in range(times)))
        self._gap = gap
        self._next_tick = 0

    def on_tick(self, record: TickRecord) -> tuple[int, int] | None:
        """Return -1 and this tick if a random penalty is due, else None; call this on every tick.

        A due penalty waits until an RLA drives and the gap since the last one is over.
        """
        due = bool(self._due) and self._due[0] <= record.tick >= self._next_tick
        if not due or not record.decision.driving or record.decision.rla_id is None:
            return None
        self._due.popleft()
        self._next_tick = record.tick + self._gap
        return -1, record.tick


class _DelayedCommand(NamedTuple):
    due_tick: int
    command: Command


class ScriptedAppraiser:
    """ScriptedTeacher in phases 1 and 2; in phases 3 and 4 it answers and gives signals; in phase 5 it is silent.

    Signals are rewards of RLAs in phase 3. In phase 4 they teach the critic, and values of 0 are given too.
    """

    def __init__(
        self,
        answering: BasicTeacher,
        timing: FeedbackTiming,
        rewards: RewardSource | None,
        appraisals: Mapping[int, str],
        *,
        session: str,
        seed: int = 0,
        demonstrated: Sequence[str] = (),
    ) -> None:
        """Create a teacher in the phase of `answering`.

        Args:
            answering: answers and corrects.
            timing: of the signals.
            rewards: source of the signals; None: no signals.
            appraisals: name of the critic's appraisal of each value.
            session: prefix of command ids, as in ScriptedTeacher.
            seed: of the demonstrations.
            demonstrated: actions of which a random one is demonstrated in phase 4 after the robot was placed. So the
                critic sees situations that the robot does not reach by itself.
        """
        self._answering = answering
        self._timing = timing
        self._rewards = rewards
        self._appraisals = appraisals
        self._session = session
        self._chance = random.Random(f"what is shown to the critic in {session}, seed {seed}")
        self._demonstrated = tuple(demonstrated)
        self._command_count = self._punishments = 0
        self._next_tick: dict[int, int] = {}
        self._next_any = 0
        self._delayed: deque[_DelayedCommand] = deque()
        self._resume_at: int | None = None
        self.phase = answering.phase

    def begin_phase(self, phase: Phase) -> Command:
        """Enter a phase; return the command that the robot needs for it."""
        self.phase = phase
        command = self._answering.begin_phase(phase)
        if phase is not Phase.CORRECTIONS:
            self._answering.phase = Phase.SUPERVISED
        return command

    def select_behaviour(self, behaviour: str) -> Command:
        """Return the command that selects a taught behaviour."""
        return self._answering.select_behaviour(behaviour)

    def resume(self) -> Command:
        """Return the command that lets the robot drive again after a stop."""
        return self._answering.resume()

    def may_be_refused(self, command_id: str) -> bool:
        """Return whether the robot may refuse a command.

        It refuses a signal if its RLA was deleted meanwhile, and a person's lesson that comes too late.
        """
        return self._answering.may_be_late or command_id.startswith(f"{self._session}-signal-")

    @property
    def times(self) -> PressTimes:
        """Times of the teacher's presses to the mid level."""
        return self._answering.times

    @property
    def available(self) -> bool:
        """True while the teacher answers questions."""
        return self.phase is not Phase.AUTONOMOUS

    def demonstrate(self, tick: int, ticks: int, probability: float = 1.0) -> list[Command]:
        """Return the command that runs a random action for `ticks`; empty with probability 1 - `probability`."""
        if not self._demonstrated or not ticks or self._chance.random() >= probability:
            return []
        self._resume_at = tick + ticks + 1
        return [RunBehaviour(self._next_id("shown"), _NAME, self._chance.choice(self._demonstrated), ticks)]

    def on_tick(self, record: TickRecord, *, touching: bool = False) -> list[Command]:
        """Return the teacher's commands in response to one tick, in order; may be empty. Call it on every tick.

        Args:
            record: of the tick.
            touching: whether the robot touches something, as a person in the room sees.
        """
        if self.phase is Phase.AUTONOMOUS:
            return []
        commands: list[Command] = []
        if self._resume_at is not None and record.tick >= self._resume_at:
            self._resume_at = None
            commands.append(Resume(self._next_id("shown"), _NAME))
        answer = self._answering.update(view_of_tick(record, touching=touching))
        if answer is not None:
            commands.append(answer)
        if self.phase in (Phase.REINFORCEMENT, Phase.CRITIC) and self._rewards is not None:
            self._judge(record, self._rewards)
        while self._delayed and self._delayed[0].due_tick <= record.tick:
            commands.append(self._delayed.popleft().command)
        return commands

    def skip(self, ahead: Ahead) -> int:
        """Let coming ticks of phase 1 or 2 pass in which this teacher does nothing; return how many."""
        return self._answering.skip(ahead)

    def answer(self, view: TeacherView) -> Command | None:
        """Return the command in response to the next tick of phase 1 or 2, in which there are no signals."""
        return self._answering.update(view)

    @property
    def command_due(self) -> int | None:
        """Tick of phase 1 or 2 in which a command is under way to arrive; None without one."""
        return self._answering.command_due

    def _judge(self, record: TickRecord, rewards: RewardSource) -> None:
        signal = rewards.on_tick(record)
        if signal is None:
            return
        value, tick = signal
        if record.tick < max(self._next_tick.get(value, 0), self._next_any):
            return
        command = (
            self._reward(value, tick, record) if self.phase is Phase.REINFORCEMENT else self._appraise(value, tick)
        )
        if command is not None and self._answering.times.allows_press():
            self._next_tick[value] = record.tick + self._timing.every[value]
            # Here, because a person's limit on presses holds back rewards that were due.
            self._punishments += isinstance(command, Reward) and value < 0
            self._next_any = record.tick + self._timing.gap
            self._delayed.append(_DelayedCommand(record.tick + self._reaction_ticks(), command))

    def _reaction_ticks(self) -> int:
        """Return the delay of a signal; a person's is drawn, and no signal overtakes the one before."""
        times = self._answering.times
        return times.reward_ticks() if isinstance(times, HumanTimes) else self._timing.reaction

    def _reward(self, value: int, tick: int, record: TickRecord) -> Command | None:
        decision = record.decision
        learned = decision.rla_id is not None or decision.cause is DecisionCause.LEARNER or tick < record.tick
        if value == 0 or not learned:
            return None
        limit = self._timing.max_punishments
        if value < 0 and limit and self._punishments >= limit:
            return None
        return Reward(self._next_id(), _NAME, value, tick)

    def _appraise(self, value: int, tick: int) -> Command | None:
        name = self._appraisals.get(value)
        return None if name is None else Appraise(self._next_id(), _NAME, name, tick)

    def _next_id(self, kind: str = "signal") -> str:
        self._command_count += 1
        return f"{self._session}-{kind}-{self._command_count}"
