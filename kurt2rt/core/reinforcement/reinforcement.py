"""Reinforcement: rewards change the values of RLAs, and RLAs below a threshold are repaired (paper, phase 3).

There are two sets of values. The teacher's values belong to phases 1 to 4; they are saved, and credits and undo refer
to them. The autonomous values start with each phase 5 and end with it, because a critic's rewards have another scale.
A teacher's reward in phase 5 changes both.
"""

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

from kurt2rt.core.basic.epsilon_greedy import EpsilonGreedy
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.reinforcement.repair import OriginOf, Repair
from kurt2rt.core.reinforcement.settings import ReinforcementSettings, ValueSettings
from kurt2rt.core.reinforcement.td_lambda import EligibilityTrace, TdLambda, make_trace
from kurt2rt.core.rla.credit import Credit
from kurt2rt.core.rla.events import (
    ActionReplaced,
    Lesson,
    LessonRedone,
    LessonUndone,
    RlaCreated,
    RlaDeleted,
    RlaRewarded,
    TeachingEvent,
)
from kurt2rt.core.rla.rla import AUTONOMOUS, CRITIC, Origin, Phase
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import FIRST_VALUE, VALUES_INCLUDE, Statistics


class _Punishment(NamedTuple):
    """Reward of -1 whose RLAs are still to be checked."""

    rlas: tuple[int, ...]
    signal: str
    """Command id of the signal."""
    teacher: str


class Reinforcement:
    """Values of RLAs from events and ticks, and the lessons that repair RLAs; the owner applies these lessons."""

    def __init__(
        self, system: RlaSystem, recent: DecisionHistory, settings: ReinforcementSettings, period_s: float
    ) -> None:
        """`recent`: stored decisions that rewards refer to; `period_s`: duration of a tick in s."""
        self._system = system
        self.recent = recent
        self._period_s = period_s
        self._settings = settings
        self._value_settings: ValueSettings = settings.with_teacher
        self.rule = self._make_rule(settings.with_teacher)
        """Teacher's values."""
        self._autonomous: TdLambda | None = None
        """Autonomous values; None outside phase 5."""
        self.choice = EpsilonGreedy(
            self.value,
            epsilon=settings.epsilon,
            hold_ticks=round(settings.hold_s / period_s),
            seed=settings.seed,
        )
        self._repair = Repair(system, self.value, settings)
        self._repair.set_thresholds(self._value_settings)
        self._depths: dict[str, tuple[int, ...]] = {}
        """Command id of each reward -> depth of each credit, so that an undo subtracts it from the right action."""
        self._autonomous_credits: dict[str, list[tuple[Credit, int]]] = {}
        """Command id of each reward in this phase 5 -> its credits in the autonomous values, with their depths."""
        self._since: dict[int, int] = {}
        """RLA id -> tick of this run in which it got its action."""
        self._punishments: list[_Punishment] = []
        self._saved = Statistics()
        """Statistics saved before this run."""
        self.rows = 0
        """Number of teaching events: the number of journal rows once all are written."""

    def value(self, rla_id: int) -> float:
        """Return the value of an RLA's present action in this phase, a score of about -1 to 1."""
        return self._active_rule.value(rla_id)

    def restore(self, events: Sequence[TeachingEvent], saved: Statistics | None) -> None:
        """Apply the events of earlier runs to the system, and restore the saved values.

        `saved` tells how many of the events its values include; credits of later events are added. Raises
        InvalidEventError if an event does not fit.
        """
        saved = saved or Statistics()
        if VALUES_INCLUDE in saved.numbers:
            self._replay(events[: round(saved.numbers[VALUES_INCLUDE])])
            self.rule.restore(self._without_deleted(saved))
        self._replay(events[self.rows :])
        self._since.clear()  # ticks of other runs
        self._punishments.clear()
        self._repair.forget_rolled_back()
        self._saved = saved

    def snapshot(self) -> Statistics:
        """Return the teacher's values for the checkpoint."""
        numbers = {VALUES_INCLUDE: float(self.rows), FIRST_VALUE: self._settings.with_teacher.first_value}
        return replace(self._saved, values=dict(self.rule.values), numbers={**self._saved.numbers, **numbers})

    def set_phase(self, phase: Phase) -> None:
        """Use the thresholds of a phase; entering phase 5 starts new autonomous values."""
        values = self._settings.alone if phase is AUTONOMOUS else self._settings.with_teacher
        if values is not self._value_settings:
            self._value_settings = values
            self._autonomous = self._make_rule(values) if phase is Phase.AUTONOMOUS else None
            self._autonomous_credits.clear()
            self._repair.set_thresholds(values)
            self.choice.reset()

    def autonomous_values(self) -> Statistics:
        """Return the values that the robot learnt by itself in phase 5; empty outside phase 5."""
        if self._autonomous is None:
            return Statistics()
        return Statistics(values=dict(self._autonomous.values))

    def restore_autonomous(self, values: Statistics, rla_ids: Collection[int]) -> None:
        """Restore the values of some RLAs in phase 5, from a result of `autonomous_values`."""
        if self._autonomous is not None:
            self._autonomous.restore(values, [rla_id for rla_id in rla_ids if self._is_active(rla_id)])
            self.choice.reset()

    def credits_for(self, value: int, tick: int) -> tuple[Credit, ...]:
        """Return the changes of values that a reward (-1 or +1) about a stored tick would make, without making them."""
        return self.rule.credits_for(value, self._trace(tick, None))

    def on_event(self, event: TeachingEvent) -> None:
        """Learn from an event that was just applied to the system: rewards, new and removed actions, undos."""
        self.rows += 1
        match event:
            case RlaRewarded(_, value, decided_at_tick, origin):
                trace = self._trace(decided_at_tick, None)
                self._depths[origin.command_id] = _depths(self.rule, event.credits)
                self.rule.learn(value, trace)
                if self._autonomous is not None:
                    alone = self._autonomous.credits_for(value, trace)
                    depths = _depths(self._autonomous, alone)
                    self._autonomous_credits[origin.command_id] = list(zip(alone, depths, strict=True))
                    self._autonomous.learn(value, trace)
                self._add_punishment(value, trace, origin.command_id, origin.teacher)
            case LessonUndone(lesson, origin):
                self._on_undone(lesson, origin)
            case LessonRedone(lesson, origin):
                self._on_redone(lesson, origin)
            case _:
                self._on_rla_changed(event, event.origin.tick)

    def signal(self, value: int, tick: int, trace_s: float) -> None:
        """Learn from a critic's signal, which is no event and changes the autonomous values only.

        Args:
            value: -1 or +1.
            tick: stored tick that the signal is about.
            trace_s: time constant of the trace in s.
        """
        trace = self._trace(tick, trace_s)
        self._active_rule.learn(value, trace)
        self._add_punishment(value, trace, CRITIC, CRITIC)

    def update(self, rla_id: int | None, tick: int) -> None:
        """Learn from a tick; `rla_id`: answering RLA, None at standstill or outside its radius."""
        self._active_rule.update(rla_id, tick)

    def repairs(self, tick: int, phase: Phase) -> Iterator[Lesson]:
        """Yield the lessons that repair RLAs punished since the last call; apply each before requesting the next.

        In phase 5 they try other actions; in earlier phases they withdraw the action or delete the RLA.
        """
        if not self._punishments:
            return
        punishments, self._punishments = self._punishments, []
        repair = self._repair.try_other_action if phase is Phase.AUTONOMOUS else self._repair.withdraw
        for punishment in punishments:
            for rla_id in punishment.rlas:
                if self._repair.is_below_threshold(rla_id):
                    yield from repair(rla_id, self._origins(punishment, phase, tick))

    def _replay(self, events: Sequence[TeachingEvent]) -> None:
        for event in events:
            self._system.apply(event)
            if isinstance(event, RlaRewarded):
                self.rows += 1
                depths = self._depths[event.origin.command_id] = _depths(self.rule, event.credits)
                self.rule.apply_credits(zip(event.credits, depths, strict=True), 1)
            else:
                self.on_event(event)

    @property
    def _active_rule(self) -> TdLambda:
        """Return the rule whose values count in this phase."""
        return self.rule if self._autonomous is None else self._autonomous

    @property
    def _rules(self) -> tuple[TdLambda, ...]:
        return (self.rule,) if self._autonomous is None else (self.rule, self._autonomous)

    def _make_rule(self, values: ValueSettings) -> TdLambda:
        return TdLambda(self._settings, values, self._period_s)

    def _origins(self, punishment: _Punishment, phase: Phase, tick: int) -> OriginOf:
        def origin_of(word: str) -> Origin:
            # The critic's signals have no ids; the number of the lesson makes each id unique.
            number = f"-{len(self._system.history.records) + 1}" if punishment.teacher == CRITIC else ""
            return Origin(f"{punishment.signal}{number}/{word}", punishment.teacher, phase, tick)

        return origin_of

    def _trace(self, tick: int, trace_s: float | None) -> EligibilityTrace:
        """Return the trace without deleted RLAs; `trace_s`: time constant in s, None: the task's."""
        seconds = self._settings.trace_s if trace_s is None else trace_s
        trace = make_trace(
            self.recent,
            tick,
            trace_ticks=seconds / self._period_s,
            since=self._since,
        )
        return {rla_id: share for rla_id, share in trace.items() if self._is_active(rla_id)}

    def _is_active(self, rla_id: int) -> bool:
        return self._system.get(rla_id) is not None

    def _without_deleted(self, saved: Statistics) -> Statistics:
        values = {rla_id: value for rla_id, value in saved.values.items() if self._is_active(rla_id)}
        return replace(saved, values=values)

    def _add_punishment(self, value: int, trace: EligibilityTrace, signal: str, teacher: str) -> None:
        if value < 0:
            self.choice.reset()
            least = self._value_settings.blamed_share
            punished = tuple(rla_id for rla_id, share in trace.items() if share >= least)
            self._punishments.append(_Punishment(punished, signal, teacher))

    def _on_undone(self, lesson: str, origin: Origin) -> None:
        match self._system.history.event_of(lesson):
            case RlaRewarded(credits=credits_):
                self.rule.apply_credits(zip(credits_, self._depths.pop(lesson), strict=True), -1)
                if self._autonomous is not None:
                    self._autonomous.apply_credits(self._autonomous_credits.pop(lesson, ()), -1)
                self.choice.reset()
            case ActionReplaced(rla_id):
                for account in self._rules:
                    account.restore_previous(rla_id)
                self._since[rla_id] = origin.tick
            case RlaDeleted(rla_id):
                for account in self._rules:
                    account.restore_previous(rla_id)
                rla = self._system.get(rla_id)
                assert rla is not None
                self._repair.on_created(rla)
            case RlaCreated(rla):
                for account in self._rules:
                    account.discard(rla.rla_id)
                self._since.pop(rla.rla_id, None)
                self._repair.on_creation_undone(rla, rolled_back=origin.teacher == CRITIC)

    def _on_redone(self, lesson: str, origin: Origin) -> None:
        """Apply a redone lesson; a reward has its original credits."""
        match self._system.history.event_of(lesson):
            case RlaRewarded(credits=credits_):
                depths = self._depths[lesson] = _depths(self.rule, credits_)
                self.rule.apply_credits(zip(credits_, depths, strict=True), 1)
                self.choice.reset()
            case event:
                self._on_rla_changed(event, origin.tick)

    def _on_rla_changed(self, event: TeachingEvent, tick: int) -> None:
        """Apply the creation, correction or deletion of an RLA at a tick."""
        match event:
            case ActionReplaced(rla_id):
                for account in self._rules:
                    account.reset(rla_id)
                self._since[rla_id] = tick
            case RlaDeleted(rla_id):
                for account in self._rules:
                    account.archive(rla_id)
                self._since.pop(rla_id, None)
                self._repair.on_deleted(rla_id)
            case RlaCreated(rla):
                self._repair.on_created(rla)


def _depths(account: TdLambda, credits_: Iterable[Credit]) -> tuple[int, ...]:
    """Return the depth of each credit: that of its RLA's present action."""
    return tuple(account.depth(credit.rla_id) for credit in credits_)
