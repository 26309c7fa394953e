"""Knowledge of a robot that is taught: the parts that depend on it, results of lessons, and its updates."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.critic.agreement import Agreement
from kurt2rt.core.critic.critic import Critic, CriticState, Opinion
from kurt2rt.core.decision.decision import Decision
from kurt2rt.core.learner.learner_level import LearnerLevel
from kurt2rt.core.outcome import CommandRefusedError, Field, Outcome, RefusalCode, ResultCode
from kurt2rt.core.outcome_text import event_error_text
from kurt2rt.core.reinforcement.reinforcement import Reinforcement
from kurt2rt.core.reinforcement.self_teaching import SelfTeaching
from kurt2rt.core.rla.events import InvalidEventError, TeachingEvent
from kurt2rt.core.rla.rla import BASIC, Phase, Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.teaching.late_press import TeacherDelay
from kurt2rt.core.teaching.mid_commands import MidCommands

_REWARDED_PHASES = (Phase.REINFORCEMENT, Phase.CRITIC)


@dataclass(frozen=True, slots=True, kw_only=True)
class HandlerParts:
    """Optional parts of a command handler, each None if the task lacks it."""

    reinforcement: Reinforcement | None = None
    """Effect of rewards; None: they have none."""
    critic: Critic | None = None
    agreement: Agreement | None = None
    self_teaching: SelfTeaching | None = None
    """Teacher of phase 5; None: the robot learns nothing then."""
    mid: MidCommands | None = None
    """Commands of the mid level; None: the teacher alone selects the behaviour."""
    delay: TeacherDelay | None = None
    """Delay of the teachers; None: it begins with the default."""
    answers_override_holds: bool = False
    """Keep what an answer or a press taught where a hold would replace it."""
    learner: LearnerLevel | None = None
    """Level of a learner that decides instead of the RLAs and gets each lesson; None: RLAs decide."""
    lesson_speed: float = 1.0
    """Fraction of their speed at which actions drive in lessons, until a teacher sets another one."""


class LessonResult(NamedTuple):
    """Outcome of a command for its teacher, and the events by which it changes the knowledge."""

    outcome: Outcome
    event: TeachingEvent | None = None
    """Change of the knowledge, by the command's own id; None if it changes nothing."""
    before: tuple[TeachingEvent, ...] = ()
    """Changes by derived ids, applied before `event`."""


def rla_outcome(code: ResultCode | RefusalCode, rla: Rla, **fields: Field) -> Outcome:
    """Return an outcome with an RLA's id, and what else its title needs: behaviour, level, image.

    `fields`: further fields of the code's text.
    """
    named: dict[str, Field] = {"rla": rla.rla_id}
    if rla.behaviour:
        named["behaviour"] = rla.behaviour
    if rla.level != BASIC:
        named["level"] = rla.level
    if rla.image:
        named["image"] = rla.image
    return Outcome(code, {**named, **fields})


def require_action(action: str, repertoire: Iterable[str]) -> None:
    """Raise CommandRefusedError, which lists the actions, if the repertoire lacks `action`."""
    names = tuple(repertoire)
    if action not in names:
        raise CommandRefusedError(RefusalCode.NO_ACTION, action=action, known=names)


def require_rla(rla_id: int, system: RlaSystem) -> Rla:
    """Return the RLA of an id. Raises CommandRefusedError if `system` has none."""
    rla = system.get(rla_id)
    if rla is None:
        raise CommandRefusedError(RefusalCode.NO_RLA, rla=rla_id)
    return rla


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
        """Learn from a tick after its wheel speeds were sent; return the events of its repairs and undos.

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
