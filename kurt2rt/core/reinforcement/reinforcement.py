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
from kurt2rt.core.reinforcement.eligibility_trace import EligibilityTrace, trace_of
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


class _Blame(NamedTuple):
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
        self._worths: ValueSettings = settings.with_teacher
        self.rule = self._account(settings.with_teacher)
        """The teacher's account."""
        self._alone: ReinforcementRule | None = None
        """That of phase 5, while it lasts."""
        self.choice = EpsilonGreedy(
            self.worth,
            epsilon=settings.epsilon,
            hold_ticks=round(settings.hold_s / period_s),
            seed=settings.seed,
        )
        self._repair = Repair(system, self.worth, settings)
        self._repair.count_from(self._worths)
        self._depths: dict[str, tuple[int, ...]] = {}
        """Of each reward in the journal, by its command id: to which actions of their RLAs its credits belong, so that
        an undo takes them off the teacher's account there."""
        self._alone_bookings: dict[str, tuple[CreditUpdate, ...]] = {}
        """Of each reward that a teacher gave in this phase 5: what an undo takes off its account."""
        self._since: dict[int, int] = {}
        """RLA id -> tick of this run in which it got the action it has."""
        self._blames: list[_Blame] = []
        self._saved = Statistics()
        """What was saved before this run: the other rule's table stays as it is there."""
        self.rows = 0
        """How many teaching events there were, which is how many rows the journal has when all of them are written."""

    def worth(self, rla_id: int) -> float:
        """What the action is worth that an RLA has now, in the account that counts in this phase."""
        return self._counting.worth(rla_id)

    def recall(self, events: Sequence[TeachingEvent], saved: Statistics | None) -> None:
        """Take in what was taught before this run, as it is applied to the system.

        What was saved tells how many of the events it includes; those behind it are booked on top of it.
        """
        saved = saved or Statistics()
        included = len(events)
        if self._is_in(saved):
            included = round(saved.numbers.get(self._include, included))
            self._recall(events[:included])
            self.rule.restore(self._of_the_living(saved))
        self._recall(events[self.rows :])
        self._since.clear()  # ticks of other runs
        self._blames.clear()
        self._repair.begin_run()
        # An earlier kurt2rt did not say how many rows a table includes: all there are.
        tables = {VALUES_INCLUDE: saved.values, EDGE_WEIGHTS_INCLUDE: saved.edge_weights}
        includes = {name: float(self.rows) for name, table in tables.items() if table}
        self._saved = replace(saved, numbers={**includes, **saved.numbers})

    def to_save(self) -> Statistics:
        """The teacher's account for the checkpoint; what the other rule had saved there stays as it is."""
        numbers = {**self._saved.numbers, self._include: float(self.rows)}
        if self._settings.rule == "td_lambda":
            numbers[FIRST_VALUE] = self._settings.with_teacher.first_value
            return replace(self._saved, values=dict(self.rule.values), numbers=numbers)
        return replace(self._saved, edge_weights=dict(self.rule.edge_weights), numbers=numbers)

    def count_for(self, phase: Phase) -> None:
        """Values of a robot that has a teacher begin elsewhere, and sink elsewhere, than those of one that is alone."""
        worths = self._settings.alone if phase is Phase.AUTONOMOUS else self._settings.with_teacher
        if worths is not self._worths:
            self._worths = worths
            self._alone = self._account(worths) if phase is Phase.AUTONOMOUS else None
            self._alone_bookings.clear()
            self._repair.count_from(worths)
            self.choice.reset()

    def worths_alone(self) -> Statistics:
        """What RLAs are worth in the account of phase 5; empty in any other phase."""
        if self._alone is None:
            return Statistics()
        return Statistics(values=dict(self._alone.values), edge_weights=dict(self._alone.edge_weights))

    def come_back(self, worths: Statistics, rla_ids: Collection[int]) -> None:
        """In the account of phase 5 these RLAs are worth again what `worths_alone` told of them."""
        if self._alone is not None:
            self._alone.restore(worths, [rla_id for rla_id in rla_ids if self._lives(rla_id)])
            self.choice.reset()

    def credits_of(self, value: int, tick: int) -> tuple[Credit, ...]:
        """What a teacher's signal about a tick that is remembered would change."""
        return self.rule.credits_of(value, self._trace(tick, None))

    def hear(self, event: TeachingEvent) -> None:
        """Follow an event that was applied to the system just now."""
        self.rows += 1
        match event:
            case RlaRewarded(_, value, decided_at_tick, origin):
                trace = self._trace(decided_at_tick, None)
                self._depths[origin.command_id] = _depths(self.rule, event.credits)
                self.rule.take(value, trace)
                if self._alone is not None:
                    credits_alone = self._alone.credits_of(value, trace)
                    self._alone_bookings[origin.command_id] = _booked(self._alone, credits_alone)
                    self._alone.take(value, trace)
                self._blame(value, trace, origin.command_id, origin.teacher)
            case LessonUndone(lesson, origin):
                self._hear_undone(lesson, origin)
            case LessonRedone(lesson, origin):
                self._hear_redone(lesson, origin)
            case _:
                self._hear_of_an_rla(event, event.origin.tick)

    def signal(self, value: int, tick: int, trace_s: float, *, signal: str, teacher: str) -> None:
        """Learn from a signal that is no event: one of the critic's, which changes the account of phase 5 only.

        `signal`: what its changes are called after.
        """
        trace = self._trace(tick, trace_s)
        self._counting.take(value, trace)
        self._blame(value, trace, signal, teacher)

    def drove(self, rla_id: int | None, tick: int) -> None:
        """Learn from a tick: the RLA that answered; None where the robot stood, or nobody may be blamed."""
        self._counting.drove(rla_id, tick)

    def repairs(self, tick: int, phase: Phase) -> Iterator[Lesson]:
        """What is to be changed after blame, one by one: apply each before the next is asked for."""
        if not self._blames:
            return
        blames, self._blames = self._blames, []
        mend = self._repair.try_another if phase is Phase.AUTONOMOUS else self._repair.ask_again
        for blame in blames:
            for rla_id in blame.rlas:
                if self._repair.sunk(rla_id):
                    yield from mend(rla_id, self._origins(blame, phase, tick))

    def _recall(self, events: Sequence[TeachingEvent]) -> None:
        for event in events:
            self._system.apply(event)
            if isinstance(event, RlaRewarded):
                self.rows += 1
                depths = self._depths[event.origin.command_id] = _depths(self.rule, event.credits)
                self.rule.book(map(CreditUpdate, event.credits, depths), 1)
            else:
                self.hear(event)

    @property
    def _include(self) -> str:
        return VALUES_INCLUDE if self._settings.rule == "td_lambda" else EDGE_WEIGHTS_INCLUDE

    def _is_in(self, saved: Statistics) -> bool:
        """Whether this rule has saved anything there."""
        table = saved.values if self._settings.rule == "td_lambda" else saved.edge_weights
        return self._include in saved.numbers or bool(table)

    @property
    def _counting(self) -> ReinforcementRule:
        """The account of this phase."""
        return self.rule if self._alone is None else self._alone

    @property
    def _accounts(self) -> tuple[ReinforcementRule, ...]:
        return (self.rule,) if self._alone is None else (self.rule, self._alone)

    def _account(self, worths: ValueSettings) -> ReinforcementRule:
        settings = self._settings
        if settings.rule == "td_lambda":
            return TdLambda(settings, worths, self._period_s)
        return EdgeWeights(settings)

    def _origins(self, blame: _Blame, phase: Phase, tick: int) -> OriginOf:
        def origin_of(word: str) -> Origin:
            # The critic's signals have no ids of their own; no two lessons are the same in number.
            number = f"-{len(self._system.lessons) + 1}" if blame.teacher == CRITIC else ""
            return Origin(f"{blame.signal}{number}/{word}", blame.teacher, phase, tick)

        return origin_of

    def _trace(self, tick: int, trace_s: float | None) -> EligibilityTrace:
        """Of those that live: what was deleted since has no part in it."""
        seconds = self._settings.trace_s if trace_s is None else trace_s
        trace = trace_of(
            self.recent,
            tick,
            trace_ticks=seconds / self._period_s,
            most_transitions=len(self._settings.factors),
            since=self._since,
        )
        shares = {rla_id: share for rla_id, share in trace.shares.items() if self._lives(rla_id)}
        return EligibilityTrace(shares, tuple(each for each in trace.transitions if all(map(self._lives, each))))

    def _lives(self, rla_id: int) -> bool:
        return self._system.get(rla_id) is not None

    def _of_the_living(self, saved: Statistics) -> Statistics:
        return replace(
            saved,
            values={rla_id: value for rla_id, value in saved.values.items() if self._lives(rla_id)},
            edge_weights={edge: weight for edge, weight in saved.edge_weights.items() if all(map(self._lives, edge))},
        )

    def _blame(self, value: int, trace: EligibilityTrace, signal: str, teacher: str) -> None:
        if value < 0:
            self.choice.reset()
            least = self._worths.blamed_share
            blamed = tuple(rla_id for rla_id, share in trace.shares.items() if share >= least)
            self._blames.append(_Blame(blamed, signal, teacher))

    def _hear_undone(self, lesson: str, origin: Origin) -> None:
        record = self._system.lesson(lesson)
        assert record is not None
        match record.event:
            case RlaRewarded(credits=credits_):
                self.rule.book(map(CreditUpdate, credits_, self._depths.pop(lesson)), -1)
                if self._alone is not None:
                    self._alone.book(self._alone_bookings.pop(lesson, ()), -1)
                self.choice.reset()
            case ActionReplaced(rla_id):
                for account in self._accounts:
                    account.go_back(rla_id)
                self._since[rla_id] = origin.tick
            case RlaDeleted(rla_id):
                for account in self._accounts:
                    account.go_back(rla_id)
                rla = self._system.get(rla_id)
                assert rla is not None
                self._repair.there(rla)
            case RlaCreated(rla):
                for account in self._accounts:
                    account.forget(rla.rla_id)
                self._since.pop(rla.rla_id, None)
                self._repair.undone(rla, rolled_back=origin.teacher == CRITIC)

    def _hear_redone(self, lesson: str, origin: Origin) -> None:
        """As when it was taught, but for what was earned in between; a reward's credits are those of then."""
        record = self._system.lesson(lesson)
        assert record is not None
        match record.event:
            case RlaRewarded(credits=credits_):
                depths = self._depths[lesson] = _depths(self.rule, credits_)
                self.rule.book(map(CreditUpdate, credits_, depths), 1)
                self.choice.reset()
            case event:
                self._hear_of_an_rla(event, origin.tick)

    def _hear_of_an_rla(self, event: TeachingEvent, tick: int) -> None:
        """That one was made, changed or deleted at that tick, for the first time or again."""
        match event:
            case ActionReplaced(rla_id):
                for account in self._accounts:
                    account.renew(rla_id)
                self._since[rla_id] = tick
            case RlaDeleted(rla_id):
                for account in self._accounts:
                    account.leave(rla_id)
                self._since.pop(rla_id, None)
                self._repair.gone(rla_id)
            case RlaCreated(rla):
                self._repair.there(rla)


def _depths(account: ReinforcementRule, credits_: Iterable[Credit]) -> tuple[int, ...]:
    """To which actions credits belong: to those that their RLAs have now."""
    return tuple(account.depth(credit.rla_id) for credit in credits_)


def _booked(account: ReinforcementRule, credits_: Sequence[Credit]) -> tuple[CreditUpdate, ...]:
    """Credits as they belong to the actions that their RLAs have now."""
    return tuple(map(CreditUpdate, credits_, _depths(account, credits_)))
