"""A teacher that consults a reference policy: answers questions, and corrects what it would do otherwise."""

import math
import random
from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

from behaviors.policies.policy import ReferencePolicy
from hal.robot_settings import RobotSettings
from kurt2rt.core.rla.programs import SCRIPTED
from kurt2rt.core.rla.rla import BASIC, Phase
from kurt2rt.core.task_settings import TaskSettings, TeacherSettings
from kurt2rt.core.teaching.commands import Command, Correct, DeleteRla, Pursue, Resume, SetPhase, Teach
from kurt2rt.core.tick import TickRecord


class TeacherView(NamedTuple):
    """What a teacher sees of the robot."""

    asking: bool
    """Whether its basic level does."""
    driving: bool
    action: str | None
    infrared_counts: tuple[int, ...]
    behaviour: str = ""
    """The taught behaviour that is wanted."""
    rla_id: int | None = None
    """The RLA whose action drives."""
    share_of_radius: float = math.inf
    """How far off its condition is, as a share of its R; infinite where another RLA's is nearer."""


def share_of_radius(driving: int | None, nearest: int | None, distance: float, radius: float) -> float:
    """As in Picture, of the RLA that drives and of the nearest one."""
    return distance / radius if driving is not None and driving == nearest else math.inf


def picture_of(record: TickRecord) -> TeacherView:
    """What a tick looks like to a teacher."""
    decision, match = record.decision, record.decision.match
    nearest = math.inf
    if match is not None:
        nearest = share_of_radius(decision.rla_id, match.rla.rla_id, match.distance, match.radius)
    return TeacherView(
        decision.asking and decision.asks_at == BASIC,
        decision.driving,
        decision.action,
        record.senses.infrared_counts,
        record.behaviour,
        decision.rla_id,
        nearest,
    )


def teacher_of(
    task: TaskSettings, robot: RobotSettings, actions: Sequence[str], *, seed: int, session: str
) -> "ScriptedTeacher":
    """The scripted teacher that a task describes, for a robot with this repertoire; `session` as in ScriptedTeacher."""
    return ScriptedTeacher(
        task.policy.build(robot.infrared),
        actions,
        task.teaching.teacher,
        replace_within_share=task.learning.insert_beyond_share,
        period_s=robot.can.cycle_s,
        seed=seed,
        session=session,
    )


class ScriptedTeacher:
    """Consistent and memoryless about the task; of its own it has only patience and reaction time.

    Sees the same pictures that a person has on the screen and answers with the same commands.
    """

    def __init__(
        self,
        policy: ReferencePolicy,
        actions: Sequence[str],
        settings: TeacherSettings,
        *,
        replace_within_share: float,
        period_s: float,
        seed: int,
        session: str,
    ) -> None:
        """`session` begins the ids of all its commands and must differ between lessons on the same knowledge.

        `replace_within_share`: up to which share of R a correction replaces an action, and so may be followed by a
        deletion.
        """
        self._session = session
        self._policy = policy
        self._actions = tuple(actions)
        self._error_rate = settings.error_rate
        self._delete_after = settings.delete_after
        self._replace_within_share = replace_within_share
        self._reaction_ticks = round(settings.reaction_s / period_s)
        self._patience_ticks = round(settings.patience_s / period_s)
        self._chance = random.Random(seed)
        self._said = 0
        self._ticks_asked = 0
        self._ticks_otherwise = 0
        self._wanted: str | None = None
        self._behaviour = ""
        self._action_of: dict[int, str] = {}
        self._replaced: Counter[int] = Counter()
        self.phase = Phase.SUPERVISED

    def enter(self, phase: Phase) -> Command:
        """Begin a phase: what to tell the robot."""
        self.phase = phase
        return SetPhase(self._next_id(), SCRIPTED, phase)

    def pursue(self, behaviour: str) -> Command:
        """Another taught behaviour is wanted: what to tell the robot."""
        return Pursue(self._next_id(), SCRIPTED, behaviour)

    def go(self) -> Command:
        """The robot shall drive again after an alarm: what to tell it."""
        return Resume(self._next_id(), SCRIPTED)

    def watch(self, picture: TeacherView, ticks: int = 1) -> Command | None:
        """See a picture, so many ticks after the one before; what the teacher says to it, if anything."""
        if picture.behaviour != self._behaviour:  # what was asked, and what was wrong, is over
            self._behaviour = picture.behaviour
            self._ticks_asked = self._ticks_otherwise = 0
        if self._delete_after:
            self._note_replaced(picture)
        if picture.asking or self._ticks_asked > 0:
            # Once asked the teacher answers, also when noise has meanwhile let the robot drive on for a moment.
            self._ticks_otherwise = 0
            self._ticks_asked += ticks
            if self._ticks_asked < self._reaction_ticks:
                return None
            self._ticks_asked = 0
            return Teach(self._next_id(), SCRIPTED, self._choose(picture))
        if self.phase is Phase.SUPERVISED or not picture.driving:
            return None
        return self._correct(picture, ticks)

    def _correct(self, picture: TeacherView, ticks: int) -> Command | None:
        wanted = self._policy.choose(picture.infrared_counts, picture.behaviour)
        if wanted == picture.action:
            self._ticks_otherwise = 0
            return None
        if wanted != self._wanted:  # patience runs for one opinion at a time
            self._wanted = wanted
            self._ticks_otherwise = 0
        self._ticks_otherwise += ticks
        if self._ticks_otherwise < self._patience_ticks:
            return None
        self._ticks_otherwise = 0
        if picture.rla_id is not None and self._is_to_go(picture.rla_id, picture.share_of_radius):
            return DeleteRla(self._next_id(), SCRIPTED, picture.rla_id)
        return Correct(self._next_id(), SCRIPTED, self._choose(picture))

    def _is_to_go(self, rla_id: int, distance_share: float) -> bool:
        """Whether an RLA that is wrong has been replaced often enough; farther off a correction leaves it as it is."""
        if not self._delete_after or self._replaced[rla_id] < self._delete_after:
            return False
        return distance_share <= self._replace_within_share

    def _note_replaced(self, picture: TeacherView) -> None:
        """An RLA that drives otherwise than before has had its action replaced."""
        if picture.rla_id is None or picture.action is None:
            return
        if self._action_of.get(picture.rla_id, picture.action) != picture.action:
            self._replaced[picture.rla_id] += 1
        self._action_of[picture.rla_id] = picture.action

    def _choose(self, picture: TeacherView) -> str:
        right = self._policy.choose(picture.infrared_counts, picture.behaviour)
        if self._chance.random() >= self._error_rate:
            return right
        return self._chance.choice([action for action in self._actions if action != right])

    def _next_id(self) -> str:
        self._said += 1
        return f"{self._session}-{self._said}"
