"""Scripted teacher with the limits of a person: late, seldom, sometimes wrong, and blind for small mistakes."""

import random
from collections.abc import Mapping
from dataclasses import dataclass

from behaviors.policies.policy import ReferencePolicy
from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.rla.programs import SCRIPTED
from kurt2rt.core.teacher_settings import PersonSettings, TeacherProfile
from kurt2rt.core.teaching.commands import Command, Correct, Teach
from kurt2rt.teacher.scripted.basic_teacher import BasicTeacher, TeacherView
from kurt2rt.teacher.scripted.delay_line import DelayLine
from kurt2rt.teacher.scripted.human_limits import Attention, DelaySampler, MistakeWatcher, PressLimit


@dataclass(frozen=True, slots=True)
class TaskSense:
    """Task as its teacher understands it."""

    policy: ReferencePolicy
    """Chooses the right action."""
    actions: tuple[str, ...]
    """Names of the robot's actions, of which an error names another one."""
    groups: Mapping[str, str]
    """Group of each action that looks alike."""


@dataclass(frozen=True, slots=True)
class _PlannedPress:
    """Press that follows a noticed question or mistake."""

    due: int
    """Tick of the press."""
    picture: TeacherView
    """State that the press is about."""


class ScriptedPerson(BasicTeacher):
    """Teacher with the delays, errors and lapses of a person, who sees old pictures over a link.

    All chance comes from the seed, in one stream for each kind of event.
    """

    may_be_late = True

    def __init__(
        self,
        profile: TeacherProfile,
        person: PersonSettings,
        sense: TaskSense,
        *,
        period_s: float,
        seed: int,
        session: str,
    ) -> None:
        """Create a teacher in phase 1.

        Args:
            profile: way to correct.
            person: limits of the person.
            sense: right actions.
            period_s: length of a tick.
            seed: of all chance.
            session: prefix of all command ids, as in ScriptedTeacher.
        """
        super().__init__(session)
        self._profile = profile
        self._person = person
        self._sense = sense

        def stream(name: str) -> str:
            return f"{name} of {session}, seed {seed}"

        slower = person.slower_per_minute
        self._question_delay = DelaySampler(person.question_delay, slower, period_s, stream("question delays"))
        self._mistake_delay = DelaySampler(person.mistake_delay, slower, period_s, stream("mistake delays"))
        self._attention = Attention(person.lapses, period_s, stream("lapses"))
        self._errors = random.Random(stream("errors"))
        self._presses = PressLimit(person.presses_per_minute, period_s)
        self._mistakes = MistakeWatcher(person.notices, sense.groups, period_s)
        link_ticks = round(person.link.one_way_s / period_s)
        self._picture_ticks = max(1, round(1.0 / person.link.pictures_per_s / period_s))
        self._effect_ticks = 2 * link_ticks + 2 * self._picture_ticks
        """Time from a press to the first picture that shows its effect."""
        self._pictures: DelayLine[TeacherView] = DelayLine(link_ticks)
        self._sent: DelayLine[Command] = DelayLine(link_ticks)
        self._now = 0
        self._next_picture = 0
        self._ignore_until = 0
        self._behaviour = ""
        self._answer: _PlannedPress | None = None
        self._correction: _PlannedPress | None = None

    def update(self, view: TeacherView, ticks: int = 1) -> Command | None:
        """Take a view that is `ticks` later than the last one; return the command that reaches the robot, if any."""
        self._now += ticks
        if self._now >= self._next_picture:
            self._next_picture = self._now + self._picture_ticks
            self._pictures.put(self._now, view)
        while (picture := self._pictures.pop(self._now)) is not None:
            if self._attention.is_on(self._now) and self._now >= self._ignore_until:
                self._look(picture)
        self._press_if_due()
        return self._sent.pop(self._now)

    def _look(self, picture: TeacherView) -> None:
        if picture.behaviour != self._behaviour:  # questions and mistakes of the last behaviour are over
            self._behaviour = picture.behaviour
            self._forget()
        if picture.asking:
            self._mistakes.reset()
            self._correction = None
            if self._answer is None:
                self._answer = _PlannedPress(self._now + self._question_delay.draw(self._now), picture)
            else:
                self._answer = _PlannedPress(self._answer.due, picture)
        elif self._may_correct(picture) and self._mistakes.update(picture, self._right(picture)):
            due = self._now + self._mistake_delay.draw(self._now)
            self._correction = _PlannedPress(due, self._corrected_picture(picture))

    def _may_correct(self, picture: TeacherView) -> bool:
        """Return whether the person watches for mistakes; no longer while a press is planned."""
        if self.phase is Phase.SUPERVISED or self._profile.corrects_by == "nothing":
            return False
        if picture.driving and self._answer is None and self._correction is None:
            return True
        self._mistakes.reset()
        return False

    def _corrected_picture(self, noticed: TeacherView) -> TeacherView:
        began = self._mistakes.began
        return began if began is not None and self._profile.corrects_tick == "began" else noticed

    def _press_if_due(self) -> None:
        if self._answer is not None and self._now >= self._answer.due:
            if not self._presses.allows(self._now):
                return  # the robot stands and waits
            picture = self._answer.picture
            action = self._choose(picture, self._person.errors.answers)
            self._send(Teach(self._next_id(), SCRIPTED, action, decision_tick=picture.tick))
        elif self._correction is not None and self._now >= self._correction.due:
            if not self._presses.allows(self._now):
                self._forget()  # the moment passes
                return
            self._correct(self._correction.picture)

    def _correct(self, picture: TeacherView) -> None:
        action = self._choose(picture, self._person.errors.corrections)
        tick = None if self._profile.corrects_tick == "pressed" else picture.tick
        self._send(Correct(self._next_id(), SCRIPTED, action, decision_tick=tick))

    def _send(self, press: Command) -> None:
        self._presses.count(self._now)
        self._sent.put(self._now, press)
        self._ignore_until = self._now + self._effect_ticks
        self._forget()

    def _forget(self) -> None:
        self._answer = self._correction = None
        self._mistakes.reset()

    def _right(self, picture: TeacherView) -> str:
        return self._sense.policy.choose(picture.infrared_counts, picture.behaviour)

    def _choose(self, picture: TeacherView, error_rate: float) -> str:
        right = self._right(picture)
        if self._errors.random() >= error_rate:
            return right
        return self._errors.choice([action for action in self._sense.actions if action != right])
