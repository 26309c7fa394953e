"""Lessons that judge what the robot did: rewards and appraisals (paper, phases 3 and 4)."""

from kurt2rt.core.outcome import CommandRefusedError, RefusalCode, ResultCode, refuse
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.reinforcement.reinforcement import Reinforcement
from kurt2rt.core.rla.events import RlaRewarded
from kurt2rt.core.rla.rla import Origin
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.teaching.appraisal_lessons import AppraisalLessons
from kurt2rt.core.teaching.commands import Appraise, Reward
from kurt2rt.core.teaching.known_names import require_rla
from kurt2rt.core.teaching.lesson_result import LessonResult, rla_outcome


class FeedbackLessons:
    """Builder of the events of rewards and appraisals; it applies none."""

    def __init__(
        self,
        system: RlaSystem,
        recent: DecisionHistory,
        reinforcement: Reinforcement | None,
        appraisal_lessons: AppraisalLessons | None,
    ) -> None:
        """Connect the RLAs, the decisions that feedback is about, and the optional parts of a `LessonBuilder`."""
        self._system = system
        self._recent = recent
        self._reinforcement = reinforcement
        self._appraisal_lessons = appraisal_lessons

    def reward(self, command: Reward, origin: Origin) -> LessonResult:
        """Return the outcome and event of a reward for the decision of a remembered tick.

        Raises CommandRefusedError for a tick that was forgotten, drove slowly or had no RLA that answered.
        """
        meant = self._known_tick(command.decision_tick)
        rla_id = self._recent.driving_rla(meant)
        if rla_id is None:
            raise CommandRefusedError(RefusalCode.NO_RLA_DROVE)
        self._require_full_speed(meant)
        rla = require_rla(rla_id, self._system)
        if self._recent.answering_rla(meant) != rla_id:
            refuse(rla_outcome(RefusalCode.OUTSIDE_RADIUS, rla))
        credits_ = () if self._reinforcement is None else self._reinforcement.credits_for(command.value, meant)
        opinion = self._recent.opinion(meant)
        said = None if opinion is None else opinion.said
        code = ResultCode.RLA_REWARDED if command.value > 0 else ResultCode.RLA_PUNISHED
        return LessonResult(rla_outcome(code, rla), RlaRewarded(rla_id, command.value, meant, origin, credits_, said))

    def appraise(self, command: Appraise, origin: Origin) -> LessonResult:
        """Return the outcome and event of an appraisal of a remembered tick. Raises CommandRefusedError."""
        if self._appraisal_lessons is None:
            raise CommandRefusedError(RefusalCode.NO_CRITIC)
        meant = self._known_tick(command.decision_tick)
        self._require_full_speed(meant)
        return self._appraisal_lessons.build(command, meant, origin)

    def _require_full_speed(self, tick: int) -> None:
        """Raise CommandRefusedError if a stored tick was slow: values and critic are about driving at full speed."""
        if self._recent.slow(tick):
            raise CommandRefusedError(RefusalCode.DROVE_SLOWLY)

    def _known_tick(self, decision_tick: int | None) -> int:
        # Default to the newest remembered tick: the previous number may have been missed.
        meant = self._recent.newest if decision_tick is None else decision_tick
        if not self._recent.contains(meant):
            raise CommandRefusedError(RefusalCode.TICK_FORGOTTEN, tick=meant)
        return meant
