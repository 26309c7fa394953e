"""Scripted teacher with the limits of a person: late, seldom, sometimes wrong, and blind for small mistakes."""

import random
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Generic, Literal, TypeVar

from behaviors.action_groups import STAND
from behaviors.policies.policy import ReferencePolicy
from kurt2rt.core.rla.lesson_history import hold_id
from kurt2rt.core.rla.rla import SCRIPTED, Phase
from kurt2rt.core.teacher_settings import Delay, PersonSettings, TeacherProfile
from kurt2rt.core.teaching.commands import Command, Correct, HoldAction, Resume, Stop, Teach, Undo
from kurt2rt.teacher.scripted.basic_teacher import Ahead, BasicTeacher, TeacherView
from kurt2rt.teacher.scripted.human_limits import AttentionLapses, DelaySampler, PressLimit
from kurt2rt.teacher.scripted.look_back import LookBack, Mistake
from kurt2rt.teacher.scripted.mistake_watcher import MistakeWatcher
from kurt2rt.teacher.scripted.press_times import HumanTimes


class PersonChance:
    """Random choices of a scripted person, one stream for each kind of event, so that none shifts another."""

    def __init__(self, person: PersonSettings, period_s: float, of: str) -> None:
        """Begin the streams; `of` tells them from those of another lesson."""

        def delays(delay: Delay, name: str) -> DelaySampler:
            return DelaySampler(delay, person.slower_per_minute, period_s, name + of)

        self.question_delay = delays(person.question_delay, "question delays")
        self.mistake_delay = delays(person.mistake_delay, "mistake delays")
        self._look_back_delay = delays(person.look_back.takes, "looks back")
        self.attention = AttentionLapses(person.lapses, period_s, "lapses" + of)
        self.errors = random.Random("errors" + of)
        self.slips = random.Random("slips that are noticed" + of)
        self._moments = random.Random("moments of mistakes" + of)
        self._moment_spread = person.look_back.moment_spread_s / period_s
        self._period_s = period_s

    def look_back(self, mistake: Mistake) -> LookBack:
        """Return the correction of a mistake by rewind."""
        return LookBack(mistake, self._look_back_delay, self._period_s)

    def moment_error_ticks(self) -> int:
        """Return the error of the moment that the person takes for the begin of a mistake."""
        return round(self._moments.gauss(0.0, self._moment_spread))


class Hand:
    """Hand of a scripted person that holds an action, and moves to the right action with a delay."""

    def __init__(self, delay_ticks: int, press_id: int, action: str, *, begins: int, ends: int) -> None:
        """Begin a press.

        Args:
            delay_ticks: time from a change of the right action to that of the hand.
            press_id: of the press.
            action: first action.
            begins: tick from which the hand follows.
            ends: tick of the release.
        """
        self.press_id = press_id
        self.action = action
        self.ends = ends
        """Tick of the release."""
        self._delay_ticks = delay_ticks
        self._target = action
        self._moves_from = begins
        self._arrives: int | None = None

    def stay(self, until: int) -> None:
        """Keep the present action until a tick, right or wrong."""
        self._moves_from = until

    def follow(self, now: int, right: str) -> None:
        """Begin to move to the right action, if no move is under way."""
        if self._arrives is None and right != self.action and now >= self._moves_from:
            self._target, self._arrives = right, now + self._delay_ticks

    def move(self, now: int) -> None:
        """Change to the target action once the hand's delay has passed."""
        if self._arrives is not None and now >= self._arrives:
            self.action, self._arrives = self._target, None


_Item = TypeVar("_Item")


class DelayLine(Generic[_Item]):
    """First-in, first-out queue with a fixed delay in ticks, for a teacher's pictures and commands."""

    def __init__(self, delay_ticks: int) -> None:
        """Delay each item by `delay_ticks`."""
        self._delay_ticks = delay_ticks
        self._items: deque[tuple[int, _Item]] = deque()

    def put(self, now: int, item: _Item) -> None:
        """Add an item in tick `now`."""
        self._items.append((now + self._delay_ticks, item))

    def pop(self, now: int) -> _Item | None:
        """Return the oldest item whose delay is over in tick `now`; None if there is none."""
        if not self._items or self._items[0][0] > now:
            return None
        return self._items.popleft()[1]

    @property
    def next_due(self) -> int | None:
        """Tick in which the oldest item comes out; None without items."""
        return self._items[0][0] if self._items else None

    def clear(self) -> None:
        """Drop all items that are still on their way."""
        self._items.clear()


_Way = Literal["press", "hold", "rewind"]
"""Way to give a press."""
_REWIND_PRESSES = 2
"""Presses of a correction by rewind; a person who has not both left does not begin one."""


@dataclass(frozen=True, slots=True)
class TaskSense:
    """Knowledge of a scripted person about its task: the right action, and which actions look alike."""

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
    by: _Way
    """Way to give it."""


@dataclass(frozen=True, slots=True)
class _PlannedUndo:
    """Undo of an own wrong press."""

    due: int
    """Tick of the press."""
    lesson: str
    """Command id of the wrong press."""


class ScriptedPerson(BasicTeacher):
    """Scripted teacher that reacts, errs and looks away like a person, over a link with delay (simulated user).

    It knows the right action from the task's policy, and gives the commands that a page gives.

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
        # No slip of the finger teaches standing: the page asks for a second touch.
        self._slip_actions = [each for each in sense.actions if sense.groups.get(each, each) != STAND]

        self._chance = PersonChance(person, period_s, f" of {session}, seed {seed}")
        self._presses = PressLimit(person.presses_per_minute, period_s)
        self.times = HumanTimes(person, self._presses, period_s=period_s, seed=seed, session=session)
        self._mistakes = MistakeWatcher(person.notices, sense.groups, period_s)
        link_ticks = round(person.link.one_way_s / period_s)
        self._picture_ticks = max(1, round(1.0 / person.link.pictures_per_s / period_s))
        self._effect_ticks = 2 * link_ticks + 2 * self._picture_ticks
        """Time from a press to the first picture that shows its effect."""
        self._pictures: DelayLine[TeacherView] = DelayLine(link_ticks)
        self._sent: DelayLine[Command] = DelayLine(link_ticks)
        self._hand_ticks = round(person.hand_delay_s / period_s)
        self._hold_ticks = round(profile.hold_s / period_s)
        self._hand: Hand | None = None
        self._look_back: LookBack | None = None
        self._press_id = 0
        self._seen: TeacherView | None = None
        self._now = 0
        self._next_picture = 0
        self._ignore_until = 0
        self._behaviour = ""
        self._touching = False
        self._touch_mistake: int | None = None
        """Tick of the last mistake that led to a touch and is corrected already."""
        self._answer: _PlannedPress | None = None
        self._correction: _PlannedPress | None = None
        self._undo: _PlannedUndo | None = None

    def update(self, view: TeacherView, ticks: int = 1) -> Command | None:
        """Process a view that is `ticks` later than the last one; return the command that reaches the robot.

        None if none does.
        """
        self._now += ticks
        self._presses.now = self._now
        if self._now >= self._next_picture:
            self._next_picture = self._now + self._picture_ticks
            self._pictures.put(self._now, view)
        while (picture := self._pictures.pop(self._now)) is not None:
            self._seen = picture
            if self._hand is not None:
                self._hand.follow(self._now, self._right(picture))
                self._hold_on(self._hand, picture)
            elif self._look_back is not None:
                self._go_on_looking_back(self._look_back, picture)
            elif self._chance.attention.is_on(self._now) and self._now >= self._ignore_until:
                self._look(picture)
        if self._hand is None and self._look_back is None:
            self._press_if_due()
        return self._sent.pop(self._now)

    def skip(self, ahead: Ahead) -> int:
        """Let the ticks pass before the next picture, press or arrival of a command."""
        due = self._next_picture
        for each in (self._pictures.next_due, self._sent.next_due, self._press_due):
            if each is not None and each < due:
                due = each
        ticks = min(ahead.ticks, max(0, due - 1 - self._now))
        self._now += ticks
        return ticks

    @property
    def command_due(self) -> int | None:
        """Tick in which a command arrives that was sent already; None without one."""
        return self._sent.next_due

    @property
    def _press_due(self) -> int | None:
        """Tick of the planned press that comes first; None without one, and while a longer act lasts."""
        if self._hand is not None or self._look_back is not None:
            return None
        planned = (self._undo, self._answer, self._correction)
        return min((each.due for each in planned if each is not None), default=None)

    def _look(self, picture: TeacherView) -> None:
        if picture.behaviour != self._behaviour:  # questions and mistakes of the last behaviour are over
            self._behaviour = picture.behaviour
            self._forget()
        if picture.asking:
            self._mistakes.reset()
            self._correction = None
            planned = self._answer
            due = self._now + self._chance.question_delay.draw(self._now) if planned is None else planned.due
            self._answer = _PlannedPress(due, picture, self._profile.answers_by)
        elif self._may_correct(picture) and self._mistakes.update(picture, self._right(picture)):
            assert self._profile.corrects_by != "nothing"
            self._plan_correction(self._corrected_picture(picture), self._profile.corrects_by)
        self._look_for_touch(picture)

    def _plan_correction(self, about: TeacherView, by: _Way) -> None:
        self._correction = _PlannedPress(self._now + self._chance.mistake_delay.draw(self._now), about, by)

    def _look_for_touch(self, picture: TeacherView) -> None:
        """Plan a look back when the robot begins to touch something, if that is this teacher's way.

        It takes the place of another correction that is planned: what led to the touch is what matters.
        """
        begins, self._touching = picture.touching and not self._touching, picture.touching
        if not begins or self.phase is Phase.SUPERVISED or self._profile.corrects_touch_by == "nothing":
            return
        about = self._mistakes.before_touch(picture.tick)
        if about is not None and self._touch_mistake != about.tick:
            self._touch_mistake = about.tick
            self._plan_correction(about, "rewind")

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
        looks_at_begin = self._profile.corrects_tick == "began" or self._profile.corrects_by == "rewind"
        return began if began is not None and looks_at_begin else noticed

    def _press_if_due(self) -> None:
        if self._undo is not None:
            if self._now >= self._undo.due and self._presses.allows():
                self._presses.count()
                self._forget()
                self._send(Undo(self._next_id(), SCRIPTED, self._undo.lesson))
                self._undo = None
        elif self._answer is not None and self._now >= self._answer.due:
            if self._presses.allows():
                self._press(self._answer, self._person.errors.answers)
            # Beyond the limit the robot stands and waits.
        elif self._correction is not None and self._now >= self._correction.due:
            if self._presses.allows(_REWIND_PRESSES if self._correction.by == "rewind" else 1):
                self._press(self._correction, self._person.errors.corrections)
            else:
                self._forget()  # the moment passes

    def _press(self, planned: _PlannedPress, error_rate: float) -> None:
        picture, answers, profile = planned.picture, planned is self._answer, self._profile
        right = self._right(picture)
        action = self._choose(right, error_rate)
        self._presses.count()
        self._forget()
        if planned.by == "hold":
            self._begin_hold(action, is_right=action == right)
            return
        if planned.by == "rewind":
            self._look_back = self._chance.look_back(self._mistake(picture, action))
            self._mistakes.forget()
            return
        seen_tick = picture.tick if self._seen is None else self._seen.tick
        command: Command
        if answers:
            command = Teach(self._next_id(), SCRIPTED, action, decision_tick=picture.tick, seen_tick=seen_tick)
        else:
            by_delay = profile.corrects_tick == "by_delay"
            tick = None if by_delay or profile.corrects_tick == "pressed" else picture.tick
            command = Correct(self._next_id(), SCRIPTED, action, decision_tick=tick, late=by_delay, seen_tick=seen_tick)
        if action != right:
            self._plan_undo(command.command_id)
        self._send(command)

    def _mistake(self, began: TeacherView, action: str) -> Mistake:
        moment = max(0, began.tick + self._chance.moment_error_ticks())
        return Mistake(moment, action, is_slip=action != self._right(began))

    def _plan_undo(self, lesson: str) -> None:
        """Plan the undo of an own wrong press, if the person notices it."""
        if self._chance.slips.random() < self._person.errors.undone:
            self._undo = _PlannedUndo(self._now + self._chance.mistake_delay.draw(self._now), lesson)

    def _send(self, command: Command) -> None:
        """Send a press, and look away from pictures from before its effect."""
        self._sent.put(self._now, command)
        self._ignore_until = self._now + self._effect_ticks

    def _go_on_looking_back(self, look_back: LookBack, picture: TeacherView) -> None:
        """Send the next press of a correction by rewind."""
        command = look_back.update(self._now, picture, self._next_id)
        if command is not None:
            if not isinstance(command, Resume):
                self._presses.count()
            self._send(command)
        if look_back.over:
            if look_back.slip is not None:
                self._plan_undo(look_back.slip)
            self._look_back = None
            self._ignore_until = self._now

    def _begin_hold(self, action: str, *, is_right: bool) -> None:
        self._press_id += 1
        ends = self._now + self._hold_ticks
        hand = Hand(self._hand_ticks, self._press_id, action, begins=self._now, ends=ends)
        if not is_right:  # a wrong button is a mistake to be noticed
            noticed = self._now + self._chance.mistake_delay.draw(self._now)
            hand.stay(noticed)
            if self._chance.slips.random() < self._person.errors.undone:
                hand.ends = noticed
                self._undo = _PlannedUndo(noticed + self._effect_ticks, hold_id(SCRIPTED, self._press_id))
        self._hand = hand
        if self._seen is not None:
            self._hold_on(hand, self._seen)

    def _hold_on(self, hand: Hand, picture: TeacherView) -> None:
        """Send the held action once more, or release it."""
        if self._now < hand.ends:
            hand.move(self._now)
            self._sent.put(self._now, HoldAction(SCRIPTED, picture.tick, hand.press_id, hand.action))
            return
        self._hand = None
        self._send(Stop(self._next_id(), SCRIPTED, hand.press_id))

    def _forget(self) -> None:
        self._answer = self._correction = None
        self._mistakes.reset()

    def _right(self, picture: TeacherView) -> str:
        return self._sense.policy.choose(picture.infrared_counts, picture.behaviour)

    def _choose(self, right: str, error_rate: float) -> str:
        if self._chance.errors.random() >= error_rate:
            return right
        return self._chance.errors.choice([action for action in self._slip_actions if action != right])
