"""Self-teaching: the critic's signals instead of a teacher, and the rollback of bad lessons (phase 5)."""

from collections.abc import Iterable, Iterator
from dataclasses import replace

from kurt2rt.core.critic.agreement import Agreement
from kurt2rt.core.critic.autonomy import Autonomy, RollbackMonitor
from kurt2rt.core.critic.critic import CriticState, Opinion
from kurt2rt.core.critic.settings import CriticSettings
from kurt2rt.core.decision.decision import Decision
from kurt2rt.core.reinforcement.reinforcement import Reinforcement
from kurt2rt.core.rla.events import LessonUndone, SituationNamed, TeachingEvent
from kurt2rt.core.rla.lesson_history import rla_id_of
from kurt2rt.core.rla.rla import AUTONOMOUS, BASIC, Phase, Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import BEST_INCLUDES, BEST_SCORE, Statistics


class SelfTeaching:
    """Learning from the critic's opinions while it is trusted in phase 5."""

    def __init__(
        self,
        reinforcement: Reinforcement,
        system: RlaSystem,
        settings: CriticSettings,
        agreement: Agreement,
        period_s: float,
    ) -> None:
        """`period_s`: duration of a tick in s."""
        self._reinforcement = reinforcement
        self._system = system
        self._agreement = agreement
        self._autonomy = Autonomy(settings, agreement, period_s)
        self.rollback = RollbackMonitor(settings.best, period_s)
        self._windows_won = 0
        self._best_values = Statistics()
        """Autonomous values at the end of the best window."""
        self.trusted = agreement.trusted
        """Return whether the critic may act; cached, because only events change it."""
        self._is_active = False
        """Return whether the critic replaced the teacher in the last tick."""

    def restore(self, events: Iterable[TeachingEvent], saved: Statistics | None) -> None:
        """Restore the rollback from events of earlier runs and saved statistics.

        The critic's lessons after the best window are unproven. `saved`: None if nothing was saved.
        """
        numbers = {} if saved is None else saved.numbers
        self.rollback.restore(events, numbers.get(BEST_SCORE), int(numbers.get(BEST_INCLUDES, 0)))

    def with_best(self, statistics: Statistics) -> Statistics:
        """Return a copy of statistics for the checkpoint, with the score of the best window added."""
        rollback = self.rollback
        numbers = {name: each for name, each in statistics.numbers.items() if name not in (BEST_SCORE, BEST_INCLUDES)}
        if rollback.best is not None:
            numbers |= {BEST_SCORE: rollback.best, BEST_INCLUDES: float(rollback.includes)}
        return replace(statistics, numbers=numbers)

    def on_event(self, event: TeachingEvent) -> None:
        """Update trust and rollback by an applied event, after the agreement has counted it."""
        self.trusted = self._agreement.trusted
        self.rollback.on_event(event)

    def set_phase(self, phase: Phase) -> bool:
        """Set the training phase; return whether the critic now replaces the teacher.

        It does in phase 5, while it is trusted.
        """
        active = phase is AUTONOMOUS and self.trusted
        if active and not self._is_active:
            self.rollback.restart()
            self._autonomy.restart()
            self._best_values = self._reinforcement.autonomous_values()
        self._is_active = active
        return active

    @property
    def state(self) -> CriticState:
        """State of the critic in the last tick."""
        if not self._is_active:
            return CriticState.LISTENS
        if self.is_measuring:
            return CriticState.MEASURES
        return CriticState.ACTS if self._autonomy.activation.needed else CriticState.NOT_NEEDED

    @property
    def bad_share(self) -> float | None:
        """Recent share of bad driven time; None while the critic only listens."""
        return self._autonomy.activation.share if self._is_active else None

    @property
    def is_measuring(self) -> bool:
        """Return whether the knowledge is being measured: nothing is learned meanwhile."""
        return self.rollback.is_measuring

    def signal(self, tick: int, decision: Decision, opinion: Opinion | None) -> None:
        """Learn from the critic's opinion of this tick as from a reward, except while measuring."""
        speaks = self._autonomy.speaks(tick, opinion, driving=decision.answers, listening=self.is_measuring)
        if speaks and opinion is not None:
            self._reinforcement.signal(opinion.value, tick, opinion.trace_s)

    def roll_back(self, tick: int, decision: Decision, opinion: Opinion | None) -> Iterator[LessonUndone]:
        """Count the tick; after a bad window, yield the undos; apply each before requesting the next.

        `decision`, `opinion`: of the tick; `opinion` None: the critic had none.
        """
        rollback = self.rollback
        said = None if opinion is None else opinion.said
        # The critic changes the basic level only; questions of other levels do not count.
        asking = decision.asking and decision.asks_at == BASIC
        undone = rollback.update(tick, said, decision.answers, asking=asking)
        if rollback.windows_won != self._windows_won:
            self._windows_won = rollback.windows_won
            self._best_values = self._reinforcement.autonomous_values()
        if undone:
            yield from self._undo(undone)

    def _undo(self, events: Iterable[LessonUndone]) -> Iterator[LessonUndone]:
        system, restored = self._system, list[Rla]()
        for event in events:
            if system.history.why_not_undo(event.lesson) is not None:  # below a teacher's lesson
                continue
            lesson = system.history.event_of(event.lesson)
            assert not isinstance(lesson, SituationNamed)  # only teachers give names
            rla_id = rla_id_of(lesson)
            was = system.get(rla_id)
            yield event
            rla = system.get(rla_id) or was
            if rla is not None:
                restored.append(rla)
        # Restored RLAs get their old values, or they would fall below the threshold at once; others keep theirs.
        ids = {each.rla_id for rla in restored for each in system.competitors(rla)}
        self._reinforcement.restore_autonomous(self._best_values, ids)
