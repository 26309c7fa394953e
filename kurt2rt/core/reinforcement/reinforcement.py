"""Reinforcement, put together: signals change what RLAs are worth, and one that has sunk is mended (paper, phase 3).

What RLAs are worth stands in two accounts. The teacher's is that of phases 1 to 4: it is saved, and it is what credits
and undo are about. That of phase 5 begins anew whenever phase 5 begins and is dropped when it ends: a critic's praise
and blame stand on another scale. What a teacher says in phase 5 is booked in both.
"""

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

from kurt2rt.core.basic.epsilon_greedy import EpsilonGreedy
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.reinforcement.edge_weights import EdgeWeights
from kurt2rt.core.reinforcement.eligibility_trace import EligibilityTrace, make_trace
from kurt2rt.core.reinforcement.repair import OriginOf, Repair
from kurt2rt.core.reinforcement.rule import CreditUpdate, ReinforcementRule
from kurt2rt.core.reinforcement.settings import ReinforcementSettings, ValueSettings
from kurt2rt.core.reinforcement.td_lambda import TdLambda
from kurt2rt.core.rla.credit import Credit
from kurt2rt.core.rla.rla import (
    CRITIC,
    ActionReplaced,
    Lesson,
    LessonRedone,
    LessonUndone,
    Origin,
    Phase,
    RlaCreated,
    RlaDeleted,
    RlaRewarded,
    TeachingEvent,
)
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import EDGE_WEIGHTS_INCLUDE, FIRST_VALUE, VALUES_INCLUDE, Statistics


class _Punishment(NamedTuple):
    """A -1 whose RLAs have yet to be looked at."""

    rlas: tuple[int, ...]
    signal: str
    """Command id of the signal."""
    teacher: str


class Reinforcement:
    """Follows the teaching events and the ticks; what it changes in the knowledge is left to its owner to apply."""

    def __init__(
        self, system: RlaSystem, recent: DecisionHistory, settings: ReinforcementSettings, period_s: float
    ) -> None:
        """`recent`: the decisions that signals are about. `period_s` of a tick."""
        self._system = system
        self.recent = recent
        self._period_s = period_s
        self._settings = settings
        self._value_settings: ValueSettings = settings.with_teacher
        self.rule = self._make_rule(settings.with_teacher)
        """The teacher's account."""
        self._autonomous: ReinforcementRule | None = None
        """That of phase 5, while it lasts."""
        self.choice = EpsilonGreedy(
            self.value,
            epsilon=settings.epsilon,
            hold_ticks=round(settings.hold_s / period_s),
            seed=settings.seed,
        )
        self._repair = Repair(system, self.value, settings)
        self._repair.set_thresholds(self._value_settings)
        self._depths: dict[str, tuple[int, ...]] = {}
        """Of each reward in the journal, by its command id: to which actions of their RLAs its credits belong, so that
        an undo takes them off the teacher's account there."""
        self._autonomous_credits: dict[str, tuple[CreditUpdate, ...]] = {}
        """Of each reward that a teacher gave in this phase 5: what an undo takes off its account."""
        self._since: dict[int, int] = {}
        """RLA id -> tick of this run in which it got the action it has."""
        self._punishments: list[_Punishment] = []
        self._saved = Statistics()
        """What was saved before this run: the other rule's table stays as it is there."""
        self.rows = 0
        """How many teaching events there were, which is how many rows the journal has when all of them are written."""

    def value(self, rla_id: int) -> float:
        """What the action is worth that an RLA has now, in the account that counts in this phase."""
        return self._active_rule.value(rla_id)

    def restore(self, events: Sequence[TeachingEvent], saved: Statistics | None) -> None:
        """Take in what was taught before this run, as it is applied to the system.

        What was saved tells how many of the events it includes; those behind it are booked on top of it.
        """
        saved = saved or Statistics()
        included = len(events)
        if self._has_saved(saved):
            included = round(saved.numbers.get(self._rows_key, included))
            self._replay(events[:included])
            self.rule.restore(self._without_deleted(saved))
        self._replay(events[self.rows :])
        self._since.clear()  # ticks of other runs
        self._punishments.clear()
        self._repair.forget_rolled_back()
        # An earlier kurt2rt did not say how many rows a table includes: all there are.
        tables = {VALUES_INCLUDE: saved.values, EDGE_WEIGHTS_INCLUDE: saved.edge_weights}
        includes = {name: float(self.rows) for name, table in tables.items() if table}
        self._saved = replace(saved, numbers={**includes, **saved.numbers})

    def snapshot(self) -> Statistics:
        """The teacher's account for the checkpoint; what the other rule had saved there stays as it is."""
        numbers = {**self._saved.numbers, self._rows_key: float(self.rows)}
        if self._settings.rule == "td_lambda":
            numbers[FIRST_VALUE] = self._settings.with_teacher.first_value
            return replace(self._saved, values=dict(self.rule.values), numbers=numbers)
        return replace(self._saved, edge_weights=dict(self.rule.edge_weights), numbers=numbers)

    def set_phase(self, phase: Phase) -> None:
        """Values of a robot that has a teacher begin elsewhere, and sink elsewhere, than those of one that is alone."""
        worths = self._settings.alone if phase is Phase.AUTONOMOUS else self._settings.with_teacher
        if worths is not self._value_settings:
            self._value_settings = worths
            self._autonomous = self._make_rule(worths) if phase is Phase.AUTONOMOUS else None
            self._autonomous_credits.clear()
            self._repair.set_thresholds(worths)
            self.choice.reset()

    def autonomous_values(self) -> Statistics:
        """What RLAs are worth in the account of phase 5; empty in any other phase."""
        if self._autonomous is None:
            return Statistics()
        return Statistics(values=dict(self._autonomous.values), edge_weights=dict(self._autonomous.edge_weights))

    def restore_autonomous(self, worths: Statistics, rla_ids: Collection[int]) -> None:
        """In the account of phase 5 these RLAs are worth again what `worths_alone` told of them."""
        if self._autonomous is not None:
            self._autonomous.restore(worths, [rla_id for rla_id in rla_ids if self._is_active(rla_id)])
            self.choice.reset()

    def credits_for(self, value: int, tick: int) -> tuple[Credit, ...]:
        """What a teacher's signal about a tick that is remembered would change."""
        return self.rule.credits_for(value, self._trace(tick, None))

    def on_event(self, event: TeachingEvent) -> None:
        """Follow an event that was applied to the system just now."""
        self.rows += 1
        match event:
            case RlaRewarded(_, value, decided_at_tick, origin):
                trace = self._trace(decided_at_tick, None)
                self._depths[origin.command_id] = _depths(self.rule, event.credits)
                self.rule.learn(value, trace)
                if self._autonomous is not None:
                    credits_alone = self._autonomous.credits_for(value, trace)
                    self._autonomous_credits[origin.command_id] = _credit_updates(self._autonomous, credits_alone)
                    self._autonomous.learn(value, trace)
                self._add_punishment(value, trace, origin.command_id, origin.teacher)
            case LessonUndone(lesson, origin):
                self._on_undone(lesson, origin)
            case LessonRedone(lesson, origin):
                self._on_redone(lesson, origin)
            case _:
                self._on_rla_changed(event, event.origin.tick)

    def signal(self, value: int, tick: int, trace_s: float, *, signal: str, teacher: str) -> None:
        """Learn from a signal that is no event: one of the critic's, which changes the account of phase 5 only.

        `signal`: what its changes are called after.
        """
        trace = self._trace(tick, trace_s)
        self._active_rule.learn(value, trace)
        self._add_punishment(value, trace, signal, teacher)

    def update(self, rla_id: int | None, tick: int) -> None:
        """Learn from a tick: the RLA that answered; None where the robot stood, or nobody may be blamed."""
        self._active_rule.update(rla_id, tick)

    def repairs(self, tick: int, phase: Phase) -> Iterator[Lesson]:
        """What is to be changed after blame, one by one: apply each before the next is asked for."""
        if not self._punishments:
            return
        blames, self._punishments = self._punishments, []
        mend = self._repair.try_other_action if phase is Phase.AUTONOMOUS else self._repair.withdraw
        for blame in blames:
            for rla_id in blame.rlas:
                if self._repair.is_below_threshold(rla_id):
                    yield from mend(rla_id, self._origins(blame, phase, tick))

    def _replay(self, events: Sequence[TeachingEvent]) -> None:
        for event in events:
            self._system.apply(event)
            if isinstance(event, RlaRewarded):
                self.rows += 1
                depths = self._depths[event.origin.command_id] = _depths(self.rule, event.credits)
                self.rule.apply_credits(map(CreditUpdate, event.credits, depths), 1)
            else:
                self.on_event(event)

    @property
    def _rows_key(self) -> str:
        return VALUES_INCLUDE if self._settings.rule == "td_lambda" else EDGE_WEIGHTS_INCLUDE

    def _has_saved(self, saved: Statistics) -> bool:
        """Whether this rule has saved anything there."""
        table = saved.values if self._settings.rule == "td_lambda" else saved.edge_weights
        return self._rows_key in saved.numbers or bool(table)

    @property
    def _active_rule(self) -> ReinforcementRule:
        """The account of this phase."""
        return self.rule if self._autonomous is None else self._autonomous

    @property
    def _rules(self) -> tuple[ReinforcementRule, ...]:
        return (self.rule,) if self._autonomous is None else (self.rule, self._autonomous)

    def _make_rule(self, worths: ValueSettings) -> ReinforcementRule:
        settings = self._settings
        if settings.rule == "td_lambda":
            return TdLambda(settings, worths, self._period_s)
        return EdgeWeights(settings)

    def _origins(self, blame: _Punishment, phase: Phase, tick: int) -> OriginOf:
        def origin_of(word: str) -> Origin:
            # The critic's signals have no ids of their own; no two lessons are the same in number.
            number = f"-{len(self._system.lessons) + 1}" if blame.teacher == CRITIC else ""
            return Origin(f"{blame.signal}{number}/{word}", blame.teacher, phase, tick)

        return origin_of

    def _trace(self, tick: int, trace_s: float | None) -> EligibilityTrace:
        """Of those that live: what was deleted since has no part in it."""
        seconds = self._settings.trace_s if trace_s is None else trace_s
        trace = make_trace(
            self.recent,
            tick,
            trace_ticks=seconds / self._period_s,
            most_transitions=len(self._settings.factors),
            since=self._since,
        )
        shares = {rla_id: share for rla_id, share in trace.shares.items() if self._is_active(rla_id)}
        return EligibilityTrace(shares, tuple(each for each in trace.transitions if all(map(self._is_active, each))))

    def _is_active(self, rla_id: int) -> bool:
        return self._system.get(rla_id) is not None

    def _without_deleted(self, saved: Statistics) -> Statistics:
        return replace(
            saved,
            values={rla_id: value for rla_id, value in saved.values.items() if self._is_active(rla_id)},
            edge_weights={
                edge: weight for edge, weight in saved.edge_weights.items() if all(map(self._is_active, edge))
            },
        )

    def _add_punishment(self, value: int, trace: EligibilityTrace, signal: str, teacher: str) -> None:
        if value < 0:
            self.choice.reset()
            least = self._value_settings.blamed_share
            blamed = tuple(rla_id for rla_id, share in trace.shares.items() if share >= least)
            self._punishments.append(_Punishment(blamed, signal, teacher))

    def _on_undone(self, lesson: str, origin: Origin) -> None:
        record = self._system.lesson(lesson)
        assert record is not None
        match record.event:
            case RlaRewarded(credits=credits_):
                self.rule.apply_credits(map(CreditUpdate, credits_, self._depths.pop(lesson)), -1)
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
        """As when it was taught, but for what was earned in between; a reward's credits are those of then."""
        record = self._system.lesson(lesson)
        assert record is not None
        match record.event:
            case RlaRewarded(credits=credits_):
                depths = self._depths[lesson] = _depths(self.rule, credits_)
                self.rule.apply_credits(map(CreditUpdate, credits_, depths), 1)
                self.choice.reset()
            case event:
                self._on_rla_changed(event, origin.tick)

    def _on_rla_changed(self, event: TeachingEvent, tick: int) -> None:
        """That one was made, changed or deleted at that tick, for the first time or again."""
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


def _depths(account: ReinforcementRule, credits_: Iterable[Credit]) -> tuple[int, ...]:
    """To which actions credits belong: to those that their RLAs have now."""
    return tuple(account.depth(credit.rla_id) for credit in credits_)


def _credit_updates(account: ReinforcementRule, credits_: Sequence[Credit]) -> tuple[CreditUpdate, ...]:
    """Credits as they belong to the actions that their RLAs have now."""
    return tuple(map(CreditUpdate, credits_, _depths(account, credits_)))
