"""Teacher that consults a reference policy: it answers questions and corrects other actions."""

import random
from collections.abc import Sequence

from behaviors.policies.policy import ReferencePolicy
from kurt2rt.core.rla.rla import SCRIPTED, Phase
from kurt2rt.core.task_settings import TeacherSettings
from kurt2rt.core.teaching.commands import Command, Correct, Teach
from kurt2rt.teacher.scripted.basic_teacher import Ahead, BasicTeacher, TeacherView
from kurt2rt.teacher.scripted.press_times import FixedTimes


class ScriptedTeacher(BasicTeacher):
    """Scripted teacher that answers by the policy after a reaction time, and corrects after its patience.

    It sees the states that a person sees on the screen, and gives the commands that a person can give.
    """

    def __init__(
        self,
        policy: ReferencePolicy,
        actions: Sequence[str],
        settings: TeacherSettings,
        *,
        period_s: float,
        seed: int,
        session: str,
        corrects: bool = True,
    ) -> None:
        """Create a teacher in phase 1.

        Args:
            policy: chooses the right action.
            actions: the robot's actions, of which an error names another one.
            settings: reaction time, patience and error rate.
            period_s: length of a tick.
            seed: of the errors.
            session: prefix of all command ids; it must differ between training runs on the same knowledge.
            corrects: False: answers only, in all phases.
        """
        super().__init__(session)
        self.times = FixedTimes(settings, period_s)
        self._corrects = corrects
        self._policy = policy
        self._actions = tuple(actions)
        self._error_rate = settings.error_rate
        self._reaction_ticks = round(settings.reaction_s / period_s)
        self._patience_ticks = round(settings.patience_s / period_s)
        self._chance = random.Random(seed)
        self._ticks_asked = 0
        self._ticks_wrong = 0
        self._right: str | None = None
        self._is_wrong = False
        """Whether the newest view showed an action that is not the right one."""
        self._behaviour = ""

    def update(self, view: TeacherView, ticks: int = 1) -> Command | None:
        """Process a view that is `ticks` later than the last one; return the teacher's command, None without one."""
        self._is_wrong = False
        if view.behaviour != self._behaviour:  # questions and errors of the last behaviour are over
            self._behaviour = view.behaviour
            self._ticks_asked = self._ticks_wrong = 0
        if view.asking or self._ticks_asked > 0:
            # A question is answered even if noise has let the robot drive on for a moment.
            self._ticks_wrong = 0
            self._ticks_asked += ticks
            if self._ticks_asked < self._reaction_ticks:
                return None
            self._ticks_asked = 0
            return Teach(self._next_id(), SCRIPTED, self._choose(view))
        if self.phase is Phase.SUPERVISED or not self._corrects or not view.driving:
            return None
        return self._correct(view, ticks)

    def skip(self, ahead: Ahead) -> int:
        """Let the ticks pass before a question, an action that is not the right one, and the end of a delay."""
        if self._ticks_asked:
            ticks = min(ahead.ticks, max(0, self._reaction_ticks - self._ticks_asked - 1))
            self._ticks_asked += ticks
            return ticks
        if self._ticks_wrong:
            if not self._is_wrong:
                return 0
            ticks = min(ahead.until_change, max(0, self._patience_ticks - self._ticks_wrong - 1))
            self._ticks_wrong += ticks
            return ticks
        answers_only = self.phase is Phase.SUPERVISED or not self._corrects
        return ahead.until_question if answers_only else ahead.until_difference

    def _correct(self, view: TeacherView, ticks: int) -> Command | None:
        right = self._policy.choose(view.infrared_counts, view.behaviour)
        if right == view.action:
            self._ticks_wrong = 0
            return None
        if right != self._right:  # patience counts for one right action at a time
            self._right = right
            self._ticks_wrong = 0
        self._ticks_wrong += ticks
        self._is_wrong = True
        if self._ticks_wrong < self._patience_ticks:
            return None
        self._ticks_wrong = 0
        return Correct(self._next_id(), SCRIPTED, self._choose(view))

    def _choose(self, view: TeacherView) -> str:
        right = self._policy.choose(view.infrared_counts, view.behaviour)
        if self._chance.random() >= self._error_rate:
            return right
        return self._chance.choice([action for action in self._actions if action != right])
