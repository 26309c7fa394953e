"""Teacher that consults a reference policy: it answers questions and corrects other actions."""

import math
import random
from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

from behaviors.policies.policy import ReferencePolicy
from hal.robot_settings import RobotSettings
from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.rla.programs import SCRIPTED
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.core.task_settings import TaskSettings, TeacherSettings
from kurt2rt.core.teaching.commands import Command, Correct, DeleteRla, Pursue, Resume, SetPhase, Teach
from kurt2rt.core.tick import TickRecord


class TeacherView(NamedTuple):
    """State of the robot as far as a teacher sees it."""

    asking: bool
    """Its basic level asks."""
    driving: bool
    action: str | None
    infrared_counts: tuple[int, ...]
    behaviour: str = ""
    """Taught behaviour that the robot follows."""
    rla_id: int | None = None
    """RLA whose action drives."""
    radius_fraction: float = math.inf
    """Distance to the condition of that RLA, divided by its R; infinite if another RLA is nearer."""


def radius_fraction(driving: int | None, nearest: int | None, distance: float, radius: float) -> float:
    """Return distance / R of the RLA that drives, a ratio; infinite if it is not the nearest one."""
    return distance / radius if driving is not None and driving == nearest else math.inf


def view_of_tick(record: TickRecord) -> TeacherView:
    """Return the teacher's view of a tick."""
    decision, match = record.decision, record.decision.match
    nearest = math.inf
    if match is not None:
        nearest = radius_fraction(decision.rla_id, match.rla.rla_id, match.distance, match.radius)
    return TeacherView(
        decision.asking and decision.asks_at == BASIC,
        decision.driving,
        decision.action,
        record.readings.infrared_counts,
        record.behaviour,
        decision.rla_id,
        nearest,
    )


def build_teacher(
    task: TaskSettings, robot: RobotSettings, actions: Sequence[str], *, seed: int, session: str
) -> "ScriptedTeacher":
    """Build the scripted teacher of a task, for a robot with these actions; `session` as in ScriptedTeacher."""
    return ScriptedTeacher(
        task.policy.build(robot.infrared),
        actions,
        task.teaching.teacher,
        replace_radius_fraction=task.learning.insert_beyond_share,
        period_s=robot.can.cycle_s,
        seed=seed,
        session=session,
    )


class ScriptedTeacher:
    """Teacher without memory of the task, with a reaction time and a patience of its own.

    It sees the states that a person sees on the screen, and gives the commands that a person can give.
    """

    def __init__(
        self,
        policy: ReferencePolicy,
        actions: Sequence[str],
        settings: TeacherSettings,
        *,
        replace_radius_fraction: float,
        period_s: float,
        seed: int,
        session: str,
    ) -> None:
        """Create a teacher in phase 1.

        Args:
            policy: chooses the right action.
            actions: the robot's actions, of which an error names another one.
            settings: reaction time, patience and error rate.
            replace_radius_fraction: a correction nearer than this fraction of R replaces the action of an RLA.
            period_s: length of a tick.
            seed: of the errors.
            session: prefix of all command ids; it must differ between training runs on the same knowledge.
        """
        self._session = session
        self._policy = policy
        self._actions = tuple(actions)
        self._error_rate = settings.error_rate
        self._delete_after = settings.delete_after
        self._replace_radius_fraction = replace_radius_fraction
        self._reaction_ticks = round(settings.reaction_s / period_s)
        self._patience_ticks = round(settings.patience_s / period_s)
        self._chance = random.Random(seed)
        self._command_count = 0
        self._ticks_asked = 0
        self._ticks_wrong = 0
        self._right: str | None = None
        self._behaviour = ""
        self._action_of: dict[int, str] = {}
        self._replaced: Counter[int] = Counter()
        self.phase = Phase.SUPERVISED

    def begin_phase(self, phase: Phase) -> Command:
        """Enter a phase; return the command that the robot needs for it."""
        self.phase = phase
        return SetPhase(self._next_id(), SCRIPTED, phase)

    def select_behaviour(self, behaviour: str) -> Command:
        """Return the command that selects a taught behaviour."""
        return Pursue(self._next_id(), SCRIPTED, behaviour)

    def resume(self) -> Command:
        """Return the command that lets the robot drive again after a stop."""
        return Resume(self._next_id(), SCRIPTED)

    def update(self, view: TeacherView, ticks: int = 1) -> Command | None:
        """Take a view that is `ticks` later than the last one; return the teacher's command, if any."""
        if view.behaviour != self._behaviour:  # questions and errors of the last behaviour are over
            self._behaviour = view.behaviour
            self._ticks_asked = self._ticks_wrong = 0
        if self._delete_after:
            self._count_replaced(view)
        if view.asking or self._ticks_asked > 0:
            # A question is answered even if noise has let the robot drive on for a moment.
            self._ticks_wrong = 0
            self._ticks_asked += ticks
            if self._ticks_asked < self._reaction_ticks:
                return None
            self._ticks_asked = 0
            return Teach(self._next_id(), SCRIPTED, self._choose(view))
        if self.phase is Phase.SUPERVISED or not view.driving:
            return None
        return self._correct(view, ticks)

    def _correct(self, view: TeacherView, ticks: int) -> Command | None:
        right = self._policy.choose(view.infrared_counts, view.behaviour)
        if right == view.action:
            self._ticks_wrong = 0
            return None
        if right != self._right:  # patience counts for one right action at a time
            self._right = right
            self._ticks_wrong = 0
        self._ticks_wrong += ticks
        if self._ticks_wrong < self._patience_ticks:
            return None
        self._ticks_wrong = 0
        if view.rla_id is not None and self._is_to_delete(view.rla_id, view.radius_fraction):
            return DeleteRla(self._next_id(), SCRIPTED, view.rla_id)
        return Correct(self._next_id(), SCRIPTED, self._choose(view))

    def _is_to_delete(self, rla_id: int, fraction: float) -> bool:
        """Return whether a wrong RLA was replaced often enough, and is near enough that a correction replaces it."""
        if not self._delete_after or self._replaced[rla_id] < self._delete_after:
            return False
        return fraction <= self._replace_radius_fraction

    def _count_replaced(self, view: TeacherView) -> None:
        """Count a replacement if an RLA drives with another action than before."""
        if view.rla_id is None or view.action is None:
            return
        if self._action_of.get(view.rla_id, view.action) != view.action:
            self._replaced[view.rla_id] += 1
        self._action_of[view.rla_id] = view.action

    def _choose(self, view: TeacherView) -> str:
        right = self._policy.choose(view.infrared_counts, view.behaviour)
        if self._chance.random() >= self._error_rate:
            return right
        return self._chance.choice([action for action in self._actions if action != right])

    def _next_id(self) -> str:
        self._command_count += 1
        return f"{self._session}-{self._command_count}"
