"""What a teacher's command teaches: the event that changes the knowledge as he said."""

from collections import Counter
from collections.abc import Iterable

from kurt2rt.layers.basic_level import BasicLevel
from kurt2rt.perception.perception import Situation
from kurt2rt.reinforcement.reinforcement import Reinforcement
from kurt2rt.rla.match import Match
from kurt2rt.rla.rla import (
    BASIC,
    MID,
    ActionReplaced,
    LessonUndone,
    Origin,
    Rla,
    RlaCreated,
    RlaDeleted,
    RlaRewarded,
    TeachingEvent,
)
from kurt2rt.teaching.appraising import Appraising
from kurt2rt.teaching.commands import Appraise, Correct, DeleteRla, ReplaceAction, Reward, Teach, Undo
from kurt2rt.teaching.meant import Meant
from kurt2rt.teaching.mid_lessons import MidLessons
from kurt2rt.teaching.recent import RecentDecisions
from kurt2rt.teaching.refused import RefusedError, refuse

LessonCommand = Teach | Correct | ReplaceAction | DeleteRla | Reward | Appraise | Undo
"""Commands that are about the knowledge."""

Taught = tuple[str, TeachingEvent | None]
"""What was done, in words, and the event that does it; None where nothing had to be."""


class Tuition:
    """Makes the events of lessons, and applies none; the teacher may mean a decision of the last seconds."""

    def __init__(
        self,
        level: BasicLevel,
        recent: RecentDecisions,
        *,
        insert_beyond_share: float,
        reinforcement: Reinforcement | None,
        appraising: Appraising | None,
        mid: MidLessons | None = None,
    ) -> None:
        """Without `reinforcement` rewards are only counted; without `appraising` there is no critic to teach.

        Without `mid` there is no mid level to teach.
        """
        self._level = level
        self._system = level.system
        self._recent = recent
        self._insert_beyond_share = insert_beyond_share
        self._reinforcement = reinforcement
        self._appraising = appraising
        self._appraisals: tuple[str, ...] = () if appraising is None else appraising.appraisals
        self._mid = mid
        self.corrections_at: Counter[str] = Counter()
        """How often a teacher has corrected, by level."""

    def event_of(self, command: LessonCommand, situation: Situation, origin: Origin) -> Taught:
        """What a command teaches in the present `situation`. Raises RefusedError."""
        match command:
            case Teach() | Correct():
                return self._lesson(command, situation, origin)
            case ReplaceAction(rla_id=rla_id, action=action):
                rla = self._require_rla(rla_id)
                self._require_action_of(rla.level, action)
                other = self._other_way(action, rla)
                if other is not None:
                    raise RefusedError(f"{other.title} says {action} there already; delete {rla.title} instead")
                return self._replace(rla, action, origin)
            case DeleteRla(rla_id=rla_id):
                return f"{self._require_rla(rla_id).title} deleted", RlaDeleted(rla_id, origin)
            case Reward():
                return self._reward(command, origin)
            case Appraise():
                return self._appraise(command, origin)
            case Undo(lesson=lesson):
                return self._undo(lesson or self._system.last_standing_lesson, origin)

    def _lesson(self, command: Teach | Correct, situation: Situation, origin: Origin) -> Taught:
        if command.level == MID:
            if self._mid is None:
                raise RefusedError("this robot has no mid level to teach")
            require_behaviour(command.action, self._level.wanted.behaviours)
            meant = self._mid.meant(command.decision_tick)
        elif command.level == BASIC:
            require_action(command.action, self._level.repertoire)
            meant = self._meant_at_the_basic_level(command.decision_tick, situation)
        else:
            raise RefusedError(f"nothing is taught at a level {command.level!r}; there are {BASIC} and {MID}")
        nearest = self._system.match(meant.vector, meant.behaviour, meant.level)
        if isinstance(command, Teach) and command.beside:
            return self._beside(command.action, meant, nearest, origin)
        # On the very condition of an RLA a second one would never win: the older one does.
        replace_within_share = 0.0
        if isinstance(command, Correct):
            self.corrections_at[command.level] += 1
            replace_within_share = meant.insert_beyond_share
        elif meant.touched or (nearest is not None and nearest.rla.asks):
            replace_within_share = meant.insert_beyond_share  # it waits for this answer
        elif meant.level == MID and nearest is not None and _may_not_stand_beside(nearest, meant):
            return self._beside(command.action, meant, nearest, origin)
        if nearest is None or nearest.distance > replace_within_share * nearest.radius:
            return self._create(command.action, meant, origin)
        rla = self._of_competitors(nearest.rla, meant)
        if rla.action == command.action:
            return f"{rla.title} says {command.action} already", None
        other = self._other_way(command.action, rla)
        if other is not None:
            return f"{other.title} says {command.action} there already; nothing was changed", None
        return self._replace(rla, command.action, origin)

    def _meant_at_the_basic_level(self, decision_tick: int | None, situation: Situation) -> Meant:
        share = self._insert_beyond_share
        if decision_tick is None:
            newest = self._recent.newest
            drove, touched = self._recent.rla(newest), self._recent.touched(newest)
            return Meant(situation.vector, self._level.wanted.behaviour, BASIC, drove, share, touched)
        self._require_known(decision_tick)
        if not self._recent.saw(decision_tick):
            raise RefusedError("the infra-red sensors were silent then, so there is no situation to teach")
        behaviour, drove = self._recent.behaviour(decision_tick), self._recent.rla(decision_tick)
        touched = self._recent.touched(decision_tick)
        return Meant(self._recent.situation(decision_tick), behaviour, BASIC, drove, share, touched)

    def _beside(self, action: str, meant: Meant, nearest: Match | None, origin: Origin) -> Taught:
        """Another RLA on the very condition of those that know the situation; where none does, a first one."""
        if meant.level != MID:
            raise RefusedError("what is possible beside it is taught at the mid level; the basic one does one thing")
        if nearest is None or not nearest.known:
            return self._create(action, meant, origin)
        for rla in self._system.competitors(nearest.rla):
            if rla.action == action:
                return f"{rla.title} says {action} already", None
        return self._create(action, meant, origin, beside=nearest.rla)

    def _of_competitors(self, nearest: Rla, meant: Meant) -> Rla:
        """Where several stand on one condition: the one that drove then, else the one that would answer."""
        group = self._system.competitors(nearest)
        if len(group) == 1 or nearest.asks:
            return nearest
        for rla in group:
            if rla.rla_id == meant.drove:
                return rla
        if meant.level != BASIC or self._reinforcement is None:
            return nearest
        return self._reinforcement.choice.best(group)

    def _create(self, action: str, meant: Meant, origin: Origin, beside: Rla | None = None) -> Taught:
        rla = Rla(
            rla_id=self._system.next_id,
            condition=tuple(meant.vector.tolist()) if beside is None else beside.condition,
            action=action,
            radius=None if beside is None else beside.radius,
            origin=origin,
            behaviour=meant.behaviour,
            level=meant.level,
        )
        others = "" if beside is None else f" beside {beside.title}"
        return f"{rla.title} taught{others}: {rla.action}", RlaCreated(rla)

    def _replace(self, rla: Rla, action: str, origin: Origin) -> Taught:
        event = ActionReplaced(rla.rla_id, action, rla.action, origin)
        if rla.asks:
            return f"{rla.title} answered anew: {action}", event
        return f"{rla.title} corrected: {action} instead of {rla.action}", event

    def _other_way(self, action: str, rla: Rla) -> Rla | None:
        """Another RLA on the same condition that says so: at the mid level they are ways, and no two are the same."""
        if rla.level != MID or rla.asks:
            return None
        return next((each for each in self._system.competitors(rla) if each is not rla and each.action == action), None)

    def _reward(self, command: Reward, origin: Origin) -> Taught:
        meant = self._meant(command.decision_tick)
        rla_id = self._recent.rla(meant)
        if rla_id is None:
            raise RefusedError("no RLA drove the robot then; there is nothing to reward or to punish")
        title = self._require_rla(rla_id).title
        if self._recent.answering(meant) != rla_id:
            raise RefusedError(f"the situation lay outside the radius of {title}, or it stood; nobody is blamed for it")
        credits_ = () if self._reinforcement is None else self._reinforcement.credits_of(command.value, meant)
        opinion = self._recent.opinion(meant)
        said = None if opinion is None else opinion.said
        word = "rewarded" if command.value > 0 else "punished"
        return f"{title} {word}", RlaRewarded(rla_id, command.value, meant, origin, credits_, said)

    def _appraise(self, command: Appraise, origin: Origin) -> Taught:
        if self._appraising is None:
            raise RefusedError("this robot has no critic")
        return self._appraising.event_of(command, self._meant(command.decision_tick), origin)

    def _undo(self, lesson: str | None, origin: Origin) -> Taught:
        if lesson is None:
            raise RefusedError("there is no lesson to undo")
        refuse(self._system.why_not_undo(lesson))
        back = self._system.comes_back(lesson)
        if back is not None and not self._can_act(back):
            raise RefusedError(
                f"{back.title} would say {back.action} again, which this task does not have; "
                "undo it with the task that it was taught with"
            )
        record = self._system.lesson(lesson)
        assert record is not None
        return f"undone: {record.text}", LessonUndone(lesson, origin)

    def _meant(self, decision_tick: int | None) -> int:
        # The newest, not the tick before this one, which may have been missed.
        meant = self._recent.newest if decision_tick is None else decision_tick
        self._require_known(meant)
        return meant

    def _require_action_of(self, level: str, action: str) -> None:
        if level == MID:
            require_behaviour(action, self._level.wanted.behaviours)
        else:
            require_action(action, self._level.repertoire if level == BASIC else self._appraisals)

    def _can_act(self, rla: Rla) -> bool:
        """Whether an RLA that comes back can be followed: knowledge may be older than the task, or another task's."""
        behaviours = self._level.wanted.behaviours
        if rla.level == BASIC:
            return rla.behaviour in behaviours and (rla.asks or rla.action in self._level.repertoire)
        if rla.level == MID:
            return self._mid is None or rla.asks or rla.action in behaviours
        return self._appraising is None or rla.action in self._appraisals

    def _require_rla(self, rla_id: int) -> Rla:
        rla = self._system.get(rla_id)
        if rla is None:
            raise RefusedError(f"there is no RLA {rla_id}; it may have been deleted")
        return rla

    def _require_known(self, tick: int) -> None:
        if not self._recent.knows(tick):
            raise RefusedError(f"the decision of tick {tick} is not remembered any more; look at the newest picture")


def _may_not_stand_beside(nearest: Match, meant: Meant) -> bool:
    """Whether a situation is at a place that is known, where a second one so near would be the same place twice."""
    return (
        meant.insert_beyond_share > 0.0
        and nearest.known
        and (nearest.distance <= meant.insert_beyond_share * nearest.radius)
    )


def require_action(action: str, repertoire: Iterable[str]) -> None:
    """Raises RefusedError, which lists those there are, for a name that a repertoire does not have."""
    names = tuple(repertoire)
    if action not in names:
        raise RefusedError(f"there is no action {action!r}; the repertoire has: {', '.join(names)}")


def require_behaviour(name: str, behaviours: Iterable[str]) -> None:
    """Raises RefusedError, which lists those there are, for a behaviour that the task does not teach."""
    names = tuple(behaviours)
    if name not in names:
        raise RefusedError(f"there is no taught behaviour {name!r}; this task has: {', '.join(names)}")
