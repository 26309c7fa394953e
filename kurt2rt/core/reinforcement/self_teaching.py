"""The critic in its teacher's place: its signals, and the guard that takes back what made things worse (phase 5)."""

from collections.abc import Iterable, Iterator
from dataclasses import replace

from kurt2rt.core.critic.agreement import Agreement
from kurt2rt.core.critic.autonomy import Autonomy
from kurt2rt.core.critic.critic import Opinion
from kurt2rt.core.critic.rollback import RollbackMonitor
from kurt2rt.core.critic.settings import CriticSettings
from kurt2rt.core.critic.state import CriticState
from kurt2rt.core.decision.decision import Decision
from kurt2rt.core.reinforcement.reinforcement import Reinforcement
from kurt2rt.core.rla.lesson_history import rla_id_of
from kurt2rt.core.rla.rla import BASIC, CRITIC, LessonUndone, Phase, Rla, SituationNamed, TeachingEvent
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import BEST_INCLUDES, BEST_SCORE, Statistics


class SelfTeaching:
    """Acts while the critic stands in its teacher's place; until then it listens."""

    def __init__(
        self,
        reinforcement: Reinforcement,
        system: RlaSystem,
        settings: CriticSettings,
        agreement: Agreement,
        period_s: float,
    ) -> None:
        """`period_s` of a tick."""
        self._reinforcement = reinforcement
        self._system = system
        self._agreement = agreement
        self._autonomy = Autonomy(settings, agreement, period_s)
        self.rollback = RollbackMonitor(settings.best, period_s)
        self._windows_won = 0
        self._best_values = Statistics()
        """Of the account of phase 5, when the best window ended."""
        self.trusted = agreement.trusted
        """Whether the critic may act; kept, because it changes only with what is heard."""
        self._is_active = False
        """Whether it stood in its teacher's place in the last tick."""

    def restore(self, events: Iterable[TeachingEvent], saved: Statistics | None) -> None:
        """Take in what was taught before this run: what the critic changed since the best window is to be proven."""
        numbers = {} if saved is None else saved.numbers
        self.rollback.restore(events, numbers.get(BEST_SCORE), int(numbers.get(BEST_INCLUDES, 0)))

    def with_best(self, statistics: Statistics) -> Statistics:
        """Statistics to be saved, with the best window as it is now."""
        best = self.rollback
        numbers = {name: each for name, each in statistics.numbers.items() if name not in (BEST_SCORE, BEST_INCLUDES)}
        if best.best is not None:
            numbers |= {BEST_SCORE: best.best, BEST_INCLUDES: float(best.includes)}
        return replace(statistics, numbers=numbers)

    def on_event(self, event: TeachingEvent) -> None:
        """Follow an event that was applied just now, and that the agreement has heard."""
        self.trusted = self._agreement.trusted
        self.rollback.on_event(event)

    def set_phase(self, phase: Phase) -> bool:
        """Whether the critic stands in its teacher's place from this tick on: in phase 5, while it is trusted."""
        alone = phase is Phase.AUTONOMOUS and self.trusted
        if alone and not self._is_active:
            self.rollback.restart()
            self._autonomy.restart()
            self._best_values = self._reinforcement.autonomous_values()
        self._is_active = alone
        return alone

    @property
    def state(self) -> CriticState:
        """What the critic did in the last tick."""
        if not self._is_active:
            return CriticState.LISTENS
        if self.is_measuring:
            return CriticState.MEASURES
        return CriticState.ACTS if self._autonomy.activation.needed else CriticState.NOT_NEEDED

    @property
    def bad_share(self) -> float | None:
        """Share of the driven time that the critic found bad lately; None while it only listens."""
        return self._autonomy.activation.share if self._is_active else None

    @property
    def is_measuring(self) -> bool:
        """Whether it is measured how good the knowledge is: nothing is learnt meanwhile."""
        return self.rollback.is_measuring

    def signal(self, tick: int, decision: Decision, opinion: Opinion | None) -> None:
        """Learn from what the critic thinks of this tick, as from a teacher's signal; while it measures only listen."""
        signal = self._autonomy.signal(tick, opinion, driving=decision.answers, listening=self.is_measuring)
        if signal is not None:
            self._reinforcement.signal(signal.value, signal.tick, signal.trace_s, signal=CRITIC, teacher=CRITIC)

    def roll_back(self, tick: int, decision: Decision, opinion: Opinion | None) -> Iterator[LessonUndone]:
        """Count the tick; after a window that was too bad, what to undo, one by one: apply each before the next."""
        best = self.rollback
        said = None if opinion is None else opinion.said
        # What the robot changes by itself is the basic level's; that another level knows no way is no fault of it.
        asking = decision.asking and decision.asks_at == BASIC
        undone = best.update(tick, said, decision.answers, asking=asking)
        if best.windows_won != self._windows_won:
            self._windows_won = best.windows_won
            self._best_values = self._reinforcement.autonomous_values()
        if undone:
            yield from self._undo(undone)

    def _undo(self, events: Iterable[LessonUndone]) -> Iterator[LessonUndone]:
        system, meant = self._system, list[Rla]()
        for event in events:
            if system.why_not_undo(event.lesson) is not None:  # a teacher went on from there: his lesson stays
                continue
            record = system.lesson(event.lesson)
            assert record is not None
            assert not isinstance(record.event, SituationNamed)  # only teachers give names
            rla_id = rla_id_of(record.event)
            was = system.get(rla_id)
            yield event
            rla = system.get(rla_id) or was
            if rla is not None:
                meant.append(rla)
        # What is come back to is as it was worth then: else the same RLAs would sink again at once. Others keep what
        # they have earned since.
        ids = {each.rla_id for rla in meant for each in system.competitors(rla)}
        self._reinforcement.restore_autonomous(self._best_values, ids)
