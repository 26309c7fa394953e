"""Scripted teacher who takes charge of the robot: it drives by held actions, and gives control back."""

from enum import StrEnum
from typing import NamedTuple

from behaviors.action_groups import STAND
from kurt2rt.core.rla.programs import SCRIPTED
from kurt2rt.core.teacher_settings import PersonSettings
from kurt2rt.core.teaching.commands import Command, HoldAction, Stop
from kurt2rt.teacher.scripted.basic_teacher import Ahead, BasicTeacher, TeacherView
from kurt2rt.teacher.scripted.delay_line import DelayLine
from kurt2rt.teacher.scripted.hand import Hand
from kurt2rt.teacher.scripted.human_limits import PressLimit
from kurt2rt.teacher.scripted.mistake_watcher import MistakeWatcher
from kurt2rt.teacher.scripted.person import TaskSense
from kurt2rt.teacher.scripted.person_chance import PersonChance
from kurt2rt.teacher.scripted.press_times import HumanTimes

AGREES_S = 2.0
"""Time of agreement after which a teacher gives control back to a robot."""


class Charge(StrEnum):
    """Rule by which control passes between teacher and robot."""

    ALWAYS = "always"
    """The teacher drives for the whole lesson."""
    NAMES = "names"
    """The teacher names the right action for the whole lesson, and the robot decides whose action drives."""
    BY_TEACHER = "by teacher"
    """The teacher takes over at a mistake, and gives back after some time of agreement."""
    BY_ROBOT = "by robot"
    """The robot asks for its teacher, and says when it can go on alone."""


class Offer(NamedTuple):
    """State of a robot that the teacher sees besides its drive."""

    action: str | None = None
    """Action that the robot would do now; None if it knows none."""
    is_ready: bool = False
    """The robot can go on alone."""
    is_fitting: bool = False
    """The robot stands and fits what it learned, so its question is none."""


class _Picture(NamedTuple):
    view: TeacherView
    offer: Offer


class TeacherInCharge(BasicTeacher):
    """Teacher with the limits of a person, who takes over, drives by held actions and gives control back.

    It has the delays, lapses and slips of `ScriptedPerson`. It differs in one point: a slip of the button is mended by
    the hand itself, and not undone.
    """

    may_be_late = True

    def __init__(
        self, person: PersonSettings, sense: TaskSense, charge: Charge, *, period_s: float, seed: int, session: str
    ) -> None:
        """Create a teacher who is not in charge yet.

        Args:
            person: limits of the person.
            sense: right actions.
            charge: rule by which control passes.
            period_s: length of a tick.
            seed: of all chance.
            session: prefix of all command ids, as in ScriptedTeacher.
        """
        super().__init__(session)
        self._person, self._sense, self._charge = person, sense, charge
        self._slip_actions = [each for each in sense.actions if sense.groups.get(each, each) != STAND]
        self._chance = PersonChance(person, period_s, f" of {session}, seed {seed}")
        self._presses = PressLimit(person.presses_per_minute, period_s)
        self.times = HumanTimes(person, self._presses, period_s=period_s, seed=seed, session=session)
        self._mistakes = MistakeWatcher(person.notices, sense.groups, period_s)
        link_ticks = round(person.link.one_way_s / period_s)
        self._picture_ticks = max(1, round(1.0 / person.link.pictures_per_s / period_s))
        self._effect_ticks = 2 * link_ticks + 2 * self._picture_ticks
        self._pictures: DelayLine[_Picture] = DelayLine(link_ticks)
        self._sent: DelayLine[Command] = DelayLine(link_ticks)
        self._hand_ticks = round(person.hand_delay_s / period_s)
        self._agrees_ticks = round(AGREES_S / period_s)
        self._hand: Hand | None = None
        self._agrees_since: int | None = None
        self._due: int | None = None
        """Tick of the planned take-over; None without one."""
        self._is_touching = False
        self._press_id = self._now = self._next_picture = self._ignore_until = 0
        self.offer = Offer()
        """State of the robot in the next tick; the run sets it."""
        self.hand_saw_tick = 0
        """Tick of the newest picture that the hand followed."""

    @property
    def hand(self) -> str | None:
        """Action that the teacher holds or names now; None if it does neither."""
        return None if self._hand is None else self._hand.action

    def update(self, view: TeacherView, ticks: int = 1) -> Command | None:
        """Process a view that is `ticks` later than the last one; return the command that reaches the robot.

        None if none does.
        """
        self._now += ticks
        self._presses.now = self._now
        if self._now >= self._next_picture:
            self._next_picture = self._now + self._picture_ticks
            self._pictures.put(self._now, _Picture(view, self.offer))
        while (picture := self._pictures.pop(self._now)) is not None:
            if self._hand is not None:
                self._hold_on(self._hand, picture)
            elif self._due is not None and self._now >= self._due:
                self._take_over(picture)
            elif self._due is None and self._chance.attention.is_on(self._now) and self._now >= self._ignore_until:
                self._look(picture)
        return self._sent.pop(self._now)

    def skip(self, ahead: Ahead) -> int:  # noqa: ARG002 - the offer changes in any tick
        """Return 0: this teacher sees every tick."""
        return 0

    def _look(self, picture: _Picture) -> None:
        """Plan a take-over if this picture gives cause for one."""
        view = picture.view
        begins, self._is_touching = view.touching and not self._is_touching, view.touching
        if self._charge in (Charge.ALWAYS, Charge.NAMES) or (view.asking and not picture.offer.is_fitting):
            self._plan(self._chance.question_delay.draw(self._now))
        elif self._charge is Charge.BY_TEACHER and view.driving:
            if self._mistakes.update(view, self._right(view)) or begins:
                self._plan(self._chance.mistake_delay.draw(self._now))
        else:
            self._mistakes.reset()

    def _plan(self, delay_ticks: int) -> None:
        self._mistakes.reset()
        self._due = self._now + delay_ticks

    def _take_over(self, picture: _Picture) -> None:
        """Press for an action, as far as presses are left; a wrong one is noticed after the delay of a mistake."""
        asks = self._charge is not Charge.BY_TEACHER or picture.view.asking
        if picture.offer.is_fitting or not self._presses.allows():
            self._due = None
            return
        self._presses.count()
        self._due, self._agrees_since = None, None
        self._press_id += 1
        right = action = self._right(picture.view)
        errors = self._person.errors
        if self._chance.errors.random() < (errors.answers if asks else errors.corrections):
            action = self._chance.errors.choice([each for each in self._slip_actions if each != right])
        hand = Hand(self._hand_ticks, self._press_id, action, begins=self._now, ends=0)
        if action != right:
            hand.stay(self._now + self._chance.mistake_delay.draw(self._now))
        self._hand = hand
        self._hold_on(hand, picture)

    def _hold_on(self, hand: Hand, picture: _Picture) -> None:
        """Send the held action once more, or give control back."""
        right, self.hand_saw_tick = self._right(picture.view), picture.view.tick
        hand.follow(self._now, right)
        hand.move(self._now)
        if self._gives_back(picture, right):
            self._hand = None
            self._ignore_until = self._now + self._effect_ticks
            self._sent.put(self._now, Stop(self._next_id(), SCRIPTED, hand.press_id))
        elif self._charge is not Charge.NAMES:
            self._sent.put(self._now, HoldAction(SCRIPTED, picture.view.tick, hand.press_id, hand.action))

    def _gives_back(self, picture: _Picture, right: str) -> bool:
        """Return whether the teacher gives control back: where it agrees, or where the robot is ready, after a while.

        A robot that cannot decide yet gets it back as soon as it says so.
        """
        if self._charge in (Charge.ALWAYS, Charge.NAMES):
            return False
        offer = picture.offer
        agrees = offer.is_ready if self._charge is Charge.BY_ROBOT or offer.action is None else offer.action == right
        if not agrees:
            self._agrees_since = None
            return False
        if self._agrees_since is None:
            self._agrees_since = self._now
        waits = self._hand_ticks if self._charge is Charge.BY_ROBOT or offer.action is None else self._agrees_ticks
        return self._now - self._agrees_since >= waits

    def _right(self, view: TeacherView) -> str:
        return self._sense.policy.choose(view.infrared_counts, view.behaviour)
