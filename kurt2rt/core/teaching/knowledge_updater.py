"""Updates of the knowledge after each decision: by lessons, rewards and the critic."""

from collections.abc import Iterable

from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.critic.critic import CriticState, Opinion
from kurt2rt.core.decision.decision import Decision
from kurt2rt.core.outcome_text import event_error_text
from kurt2rt.core.rla.event_error import InvalidEventError
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.teaching.handler_parts import HandlerParts

_REWARDED_PHASES = (Phase.REINFORCEMENT, Phase.CRITIC)


class KnowledgeUpdater:
    """Only place where the knowledge of a running robot changes; it notifies the parts that depend on it."""

    def __init__(self, level: BasicLevel, handled_command_ids: Iterable[str], parts: HandlerParts) -> None:
        """Connect the parts; `handled_command_ids`: of earlier runs."""
        self._level = level
        self._reinforcement = parts.reinforcement
        self._self_teaching = parts.self_teaching
        self._followers = [
            each
            for each in (parts.reinforcement, parts.agreement, parts.self_teaching, parts.learner)
            if each is not None
        ]
        self.handled_ids = set(handled_command_ids)
        """Ids of all commands that were carried out, and of all repairs."""
        self.error = ""
        """Changes that did not fit the knowledge and were skipped, in one line; empty without any."""
        self._skipped = 0

    @property
    def critic_state(self) -> CriticState:
        """Critic's state in the last tick; LISTENS without a critic."""
        return CriticState.LISTENS if self._self_teaching is None else self._self_teaching.state

    @property
    def bad_share(self) -> float | None:
        """Fraction of recently driven time that the critic found bad; None while it only listens."""
        return None if self._self_teaching is None else self._self_teaching.bad_share

    def apply(self, event: TeachingEvent) -> None:
        """Apply an event and notify the dependent parts. Raises InvalidEventError without having changed anything."""
        self._level.apply(event)
        self.handled_ids.add(event.origin.command_id)
        for follower in self._followers:
            follower.on_event(event)

    def learn_from_tick(
        self, phase: Phase, tick: int, decision: Decision, opinion: Opinion | None
    ) -> list[TeachingEvent]:
        """Learn from a tick's decision and the critic's opinion of it; return the events.

        The events act from the next tick on and have to reach the journal.
        """
        reinforcement, alone = self._reinforcement, self._self_teaching
        if reinforcement is None:
            return []
        reinforcement.set_phase(phase)
        if alone is not None and not alone.set_phase(phase):
            alone = None
        changes_itself = alone is not None and not alone.is_measuring
        learns = phase in _REWARDED_PHASES or changes_itself
        reinforcement.choice.explores = learns
        if learns:
            reinforcement.update(decision.rla_id if decision.answers else None, tick)
        if alone is not None:
            alone.signal(tick, decision, opinion)
        events: list[TeachingEvent] = []
        for lesson in reinforcement.repairs(tick, phase):
            self.apply_own(lesson, events)
        if alone is not None:
            for undone in alone.roll_back(tick, decision, opinion):
                self.apply_own(undone, events)
        return events

    def apply_own(self, event: TeachingEvent, events: list[TeachingEvent]) -> None:
        """Apply an event that the robot itself made and append it to `events`.

        An event that does not fit is skipped and reported in `error`.
        """
        try:
            self.apply(event)
        except InvalidEventError as error:
            self._skipped += 1
            last = event_error_text(error)
            self.error = f"changes that did not fit the knowledge were skipped: {self._skipped}, the last: {last}"
        else:
            events.append(event)
