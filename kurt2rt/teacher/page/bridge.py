"""Between the open pages and the robot: pictures one way, orders and the teacher's hand the other."""

import contextlib
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import anyio
import anyio.abc

from kurt2rt.channel.protocol.state import State
from kurt2rt.core.outcome import Outcome, RefusalCode
from kurt2rt.core.outcome_text import Surface, text_of
from kurt2rt.core.rla.rla import Phase
from kurt2rt.teacher.client.answer import Answer, NoAnswerError
from kurt2rt.teacher.page.commands import carry_out, ends_run, lets_drive, oldest_picture_s
from kurt2rt.teacher.page.control_lease import ControlLease
from kurt2rt.teacher.page.messages import Hidden, PageHeartbeat, PageMessage, PageOrder, Press, Release, StopNow, Why
from kurt2rt.teacher.page.operator_presence import OperatorPresence
from kurt2rt.teacher.page.page_connection import PageConnection
from kurt2rt.teacher.page.robot_link import RobotLink
from kurt2rt.teacher.page.sent_states import SentState
from kurt2rt.teacher.page.slow_state import SlowState
from kurt2rt.teacher.page.views import answer_view, refusal_view, state_view
from kurt2rt.teacher.page.why_view import why_view

_LOOK_EACH_S = 0.01
"""How late a silent page is noticed at most."""
_SILENT_S = 0.5
"""A robot not heard of for so long is said to be silent, and so often."""
_MOST_ORDERS = 8
"""That one page may have under way."""

_NOT_YOURS = "another page has the pad; press Take to have it here"
_NO_PICTURE = "the page showed no picture of the robot as it runs now; look, and press again"
_OLD_PICTURE = text_of(Outcome(RefusalCode.OLD_PICTURE), Surface.PAGE)
_STOPPED_MEANWHILE = text_of(Outcome(RefusalCode.STOPPED_SINCE), Surface.PAGE)
_BUSY = "the robot has not answered the last ones yet; wait"
_NOBODY_LOOKED = "nobody saw the robot on this page: it was stopped; GO lets it drive on"


class Bridge:
    """Serves all open pages of one device.

    One page has the pad. Its heartbeats are what tells the robot that the teacher looks; its presses drive for as long
    as they come. Every page may stop the robot.
    """

    def __init__(
        self, robot: RobotLink, device: str, robot_place: str, *, now: Callable[[], float] = time.monotonic
    ) -> None:
        """`robot_place` is where the robot should be, for the page; `now` a clock in s that only grows."""
        self._robot = robot
        self._device = device
        self._robot_place = robot_place
        self._now = now
        self._seat = ControlLease()
        self._attention = OperatorPresence()
        self._visitors: dict[int, PageConnection] = {}
        self._opened = 0
        self._carried_out = 0
        self._newest: State | None = None
        self._stopped_s = float("-inf")
        self._unseen_stop_due = False
        self._ended_boot: bytes | None = None
        """Start of the robot that ended because a page wanted the next run: it is silent, and stands."""
        self._ending = 0
        self._said_silent_s = float("-inf")
        self._tasks: anyio.abc.TaskGroup | None = None
        self._rarely = SlowState(robot, self._tell_all, lambda: self._carried_out)

    async def run(self, *, task_status: anyio.abc.TaskStatus[None] = anyio.TASK_STATUS_IGNORED) -> None:
        """Serve until cancelled; the wheels are let go at the end."""
        async with anyio.create_task_group() as tasks:
            self._tasks = tasks
            self._rarely.start(tasks)
            for task in (self._follow_pictures, self._keep_watch):
                tasks.start_soon(task)
            task_status.started()

    async def end(self) -> None:
        """Let go of the robot before the program ends; it stands if it was driven by hand. Raises NoAnswerError."""
        self._robot.watching = False
        held = [each for each in self._visitors.values() if each.grip.held]
        for visitor in held:
            visitor.grip.release()
        if held:
            await self._robot.let_go()

    # Pages

    @property
    def visitors(self) -> int:
        """Number of open pages."""
        return len(self._visitors)

    def dismiss(self) -> None:
        """Close every page's connection; it may come again, and shows its cookie then."""
        for visitor in self._visitors.values():
            visitor.lost = True
            visitor.look()

    def arrive(self) -> PageConnection:
        """A page was opened."""
        self._opened += 1
        visitor = PageConnection(self._opened)
        before = self._seat.holder
        self._visitors[visitor.number] = visitor
        self._seat.arrive(visitor.number, self._now())
        self._seat_changed(before)
        for about, copy in self._rarely.copies():
            visitor.tell(copy, about=about)
        return visitor

    def leave(self, visitor: PageConnection) -> None:
        """A page was closed, or lost."""
        before = self._seat.holder
        self._seat.leave(visitor.number)
        self._seat_changed(before)
        self._let_go(visitor)
        del self._visitors[visitor.number]

    def hear(self, visitor: PageConnection, message: PageMessage) -> None:
        """Do what a page says."""
        match message:
            case PageHeartbeat():
                self._heartbeat(visitor, message)
            case Hidden():
                visitor.visible = False
                self._seat.hide(visitor.number)
                if self._has_pad(visitor):
                    self._attention.lose()
                    self._look()
                self._let_go(visitor)
            case Press():
                self._press(visitor, message)
            case Release():
                self._let_go(visitor)
            case StopNow():
                self._stopped_s = self._now()
                for each in self._visitors.values():
                    each.grip.release()
                self._spawn(self._answer, visitor, message.number, self._robot.stop)
            case Why():
                if visitor.orders >= _MOST_ORDERS:
                    visitor.tell(refusal_view(message.number, "busy", _BUSY))
                else:
                    self._spawn(self._explain, visitor, message.number)
            case PageOrder():
                self._order(visitor, message)

    def _has_pad(self, visitor: PageConnection) -> bool:
        return self._seat.holder == visitor.number

    def _heartbeat(self, visitor: PageConnection, beat: PageHeartbeat) -> None:
        now_s = self._now()
        visitor.visible = True
        visitor.beat = (beat.at_ms, now_s)
        self._seat.hear(visitor.number, now_s)
        if beat.picture is not None:
            visitor.pictures.see(beat.picture)
        if self._has_pad(visitor):
            self._attention.beat(visitor.pictures.age_s(beat.picture, now_s), now_s)
            self._look()
        visitor.look()

    def _press(self, visitor: PageConnection, press: Press) -> None:
        if self._ending:
            return  # the press before is on until its end was begun; the next message of this one comes in 50 ms
        if not self._has_pad(visitor):
            visitor.tell({"kind": "let_go", "text": _NOT_YOURS}, about="let_go")
            return
        now_s = self._now()
        age_s = visitor.pictures.age_s(press.picture, now_s)
        if visitor.grip.is_on(press.hold) and not self._robot.pressing:
            # The robot refused it, or was stopped: going on would be a new press that nobody made.
            visitor.grip.release()
            visitor.tell({"kind": "let_go", "text": self._why_refused()}, about="let_go")
        elif visitor.grip.press(press.hold, age_s, now_s):
            self._robot.press(press.left_m_s, press.right_m_s)

    def _order(self, visitor: PageConnection, order: PageOrder) -> None:
        if order.name != "take" and not self._has_pad(visitor):
            visitor.tell(refusal_view(order.number, "watching", _NOT_YOURS))
            return
        picture = visitor.pictures.get(order.picture)
        if picture is None or self._newest is None or picture.boot != self._newest.boot:
            visitor.tell(refusal_view(order.number, "stale", _NO_PICTURE))
        elif self._now() - picture.sent_s > oldest_picture_s(order):
            # The robot is told of our newest picture, not of the page's: only here the order's age is known.
            visitor.tell(refusal_view(order.number, "stale", _OLD_PICTURE))
        elif lets_drive(order) and picture.sent_s < self._stopped_s:
            visitor.tell(refusal_view(order.number, "stopped", _STOPPED_MEANWHILE))
        elif order.name == "take" and self._take_pad(visitor):
            visitor.tell({**refusal_view(order.number, "", "this page has the pad"), "accepted": True})
        else:
            self._start(visitor, order.number, partial(self._carry_out, order, picture))

    async def _carry_out(self, order: PageOrder, picture: SentState) -> Answer:
        answer = await carry_out(order, self._robot, picture.tick)
        if answer.accepted and ends_run(order):
            self._ended_boot = picture.boot
        return answer

    def _take_pad(self, visitor: PageConnection) -> bool:
        """Give a page the pad; whether this device is the robot's teacher already."""
        before = self._seat.holder
        self._seat.take(visitor.number, self._now())
        self._seat_changed(before)
        return self._newest is not None and self._newest.teacher == self._device

    def _start(self, visitor: PageConnection, number: int, command: Callable[[], Any]) -> None:
        if visitor.orders >= _MOST_ORDERS:
            visitor.tell(refusal_view(number, "busy", _BUSY))
            return
        self._spawn(self._answer, visitor, number, command)

    async def _answer(self, visitor: PageConnection, number: int, command: Callable[[], Any]) -> None:
        visitor.orders += 1
        try:
            view = answer_view(number, await command())
        except NoAnswerError as error:
            view = refusal_view(number, "unknown", str(error))
        finally:
            visitor.orders -= 1
        self._carried_out += 1
        # A list of lessons that is fetched from now on, `after` this one, has in it what the order has changed.
        visitor.tell({**view, "done": self._carried_out})
        if self._newest is not None:
            self._rarely.see_lessons(self._newest)

    async def _explain(self, visitor: PageConnection, number: int) -> None:
        visitor.orders += 1
        try:
            view = why_view(number, await self._robot.why(), self._rarely.words)
        except NoAnswerError as error:
            view = refusal_view(number, "unknown", str(error))
        finally:
            visitor.orders -= 1
        visitor.tell(view)

    # The teacher's hand and eyes

    def _seat_changed(self, before: int | None) -> None:
        if self._seat.holder != before:
            if self._seat.holder is None:
                self._attention.lose()  # else who took the pad looks; the first heartbeat is under way
                self._look()
            if before in self._visitors:
                self._let_go(self._visitors[before])
        for visitor in self._visitors.values():
            here = self._has_pad(visitor)
            seat = "here" if here else "free" if self._seat.holder is None else "elsewhere"
            page = {"kind": "page", "device": self._device, "robot": self._robot_place, "seat": seat}
            visitor.tell(page, about="page")

    def _let_go(self, visitor: PageConnection) -> None:
        if visitor.grip.held:
            visitor.grip.release()
            self._ending += 1
            self._spawn(self._end_press)

    def _why_refused(self) -> str:
        refusal = self._robot.refusal
        return "" if refusal is None else refusal.text_on(Surface.PAGE) or refusal.why

    async def _end_press(self) -> None:
        self._ending -= 1
        try:
            # Ends the press before it waits for anything.
            await self._robot.let_go()
        except NoAnswerError:
            # It stops by itself when it does not hear us; that it is silent is said with every picture that is missing.
            self._tell_all({"kind": "let_go", "text": "the robot did not answer the stop at the end"}, about="let_go")

    async def _keep_watch(self) -> None:
        while True:
            await anyio.sleep(_LOOK_EACH_S)
            self.look()

    def look(self) -> None:
        """Once in a while: silent pages lose the wheel, and nobody looks through them; a silent robot is said to be."""
        now_s = self._now()
        for visitor in self._visitors.values():
            if visitor.grip.expired(now_s):
                self._let_go(visitor)
                text = "this page was not heard of for 250 ms: the robot was stopped; press anew"
                visitor.tell({"kind": "let_go", "text": text}, about="let_go")
        self._look()
        if self._robot.state_age_s > _SILENT_S and now_s - self._said_silent_s >= _SILENT_S:
            self._said_silent_s = now_s
            self._tell_all({"kind": "silent", "text": self._why_silent()}, about="silent")

    def _look(self) -> None:
        there = self._attention.there(self._now())
        self._robot.watching = there
        if there:
            self._unseen_stop_due = True
        elif self._unseen_stop_due and self._drives_for_its_teacher():
            # The robot's own patience begins only with the last word it has heard: together they would be too long.
            self._unseen_stop_due = False
            self._spawn(self._stop_unseen)

    def _drives_for_its_teacher(self) -> bool:
        state = self._newest
        return (
            state is not None
            and state.boot != self._ended_boot
            and state.teacher == self._device
            and state.phase < Phase.AUTONOMOUS
            and state.action is not None
            and not state.by_hand  # a press ends by its own stop
        )

    async def _stop_unseen(self) -> None:
        self._tell_all({"kind": "let_go", "text": _NOBODY_LOOKED}, about="let_go")
        # One that does not answer hears nothing of a teacher either, and stops by itself.
        with contextlib.suppress(NoAnswerError):
            await self._robot.stop()

    def _why_silent(self) -> str:
        why = f" ({self._robot.trouble})" if self._robot.trouble else ""
        if self._newest is None:
            return f"no robot at {self._robot_place}; is kurt2rt run running?{why}"
        return f"nothing heard of the robot at {self._robot_place}{why}"

    def _spawn(self, task: Callable[..., Any], *arguments: object) -> None:
        assert self._tasks is not None, "the bridge runs before a page is served"
        self._tasks.start_soon(task, *arguments)

    # What comes from the robot

    async def _follow_pictures(self) -> None:
        async for state in self._robot.states():
            if state.stopped is not None and (self._newest is None or state.stopped != self._newest.stopped):
                self._stopped_s = self._now()
            self._newest = state
            self._look()
            self._rarely.see(state, watched=bool(self._visitors))
            view = state_view(state, self._robot.link, self._robot.state_age_s, self._why_refused(), self._rarely.words)
            for visitor in self._visitors.values():
                visitor.show(state.boot, view)

    def _tell_all(self, message: dict[str, Any], about: str) -> None:
        for visitor in self._visitors.values():
            visitor.tell(message, about=about)
