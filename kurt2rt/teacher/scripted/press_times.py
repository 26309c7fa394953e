"""Times, limits and errors of the presses that a scripted teacher gives to the mid level and as rewards."""

from typing import Protocol

from kurt2rt.core.task_settings import TeacherSettings
from kurt2rt.core.teacher_settings import PersonSettings
from kurt2rt.teacher.scripted.human_limits import DelaySampler, PressLimit


class PressTimes(Protocol):
    """Times in ticks and errors of a scripted teacher's presses; each call draws one time."""

    answer_errors: float
    """Fraction of answers that are wrong."""
    correction_errors: float
    """Fraction of corrections that are wrong."""

    def question_ticks(self) -> int:
        """Return the time from a question to its answer."""
        ...

    def mistake_ticks(self) -> int:
        """Return the time from the begin of a mistake to its correction."""
        ...

    def reward_ticks(self) -> int:
        """Return the time from an event to its reward."""
        ...

    def allows_press(self) -> bool:
        """Return whether the teacher may press now; count the press if so."""
        ...


class FixedTimes:
    """Times of a teacher without a person's limits: the same for each event, any number of presses."""

    def __init__(self, settings: TeacherSettings, period_s: float) -> None:
        """Use the settings of a task; `period_s` is the length of a tick."""
        self.answer_errors = self.correction_errors = settings.error_rate
        self._reaction_ticks = round(settings.reaction_s / period_s)
        self._patience_ticks = round(settings.patience_s / period_s)

    def question_ticks(self) -> int:
        """Return the reaction time in ticks."""
        return self._reaction_ticks

    def mistake_ticks(self) -> int:
        """Return the patience in ticks."""
        return self._patience_ticks

    def reward_ticks(self) -> int:
        """Return the reaction time in ticks."""
        return self._reaction_ticks

    def allows_press(self) -> bool:
        """Return True: there is no limit on presses."""
        return True


class HumanTimes:
    """Times of a teacher with a person's limits, drawn for each event, with both ways of the link."""

    def __init__(
        self, person: PersonSettings, presses: PressLimit, *, period_s: float, seed: int, session: str
    ) -> None:
        """Draw times in streams of their own.

        Args:
            person: limits of the person.
            presses: limit that all presses of the person share.
            period_s: length of a tick.
            seed: of the times.
            session: prefix of command ids, as in ScriptedTeacher.
        """
        self.answer_errors, self.correction_errors = person.errors.answers, person.errors.corrections
        self._presses = presses
        self._link_ticks = 2 * round(person.link.one_way_s / period_s)
        self._notice_ticks = round(person.notices.different_after_s / period_s)

        def sampler(name: str) -> DelaySampler:
            delay = {"question": person.question_delay, "mistake": person.mistake_delay, "reward": person.reward_delay}
            stream = f"{name} delays of other presses in {session}, seed {seed}"
            return DelaySampler(delay[name], person.slower_per_minute, period_s, stream)

        self._question, self._mistake, self._reward = sampler("question"), sampler("mistake"), sampler("reward")

    def question_ticks(self) -> int:
        """Return a drawn reaction to a question, in ticks."""
        return self._question.draw(self._presses.now) + self._link_ticks

    def mistake_ticks(self) -> int:
        """Return the time to notice a mistake, and a drawn reaction to it, together in ticks."""
        return self._notice_ticks + self._mistake.draw(self._presses.now) + self._link_ticks

    def reward_ticks(self) -> int:
        """Return a drawn delay of a reward, in ticks."""
        return self._reward.draw(self._presses.now) + self._link_ticks

    def allows_press(self) -> bool:
        """Return whether the limit allows a press now; count it if so."""
        if not self._presses.allows():
            return False
        self._presses.count()
        return True
