"""Bridge between the open pages and the robot: states to the pages, commands and presses to the robot."""

import contextlib
from collections.abc import Awaitable, Callable
from functools import partial
from typing import Any

import anyio
import anyio.abc

from kurt2rt.channel.protocol.requests import LoadRequest, NextRunRequest
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.outcome import Outcome, RefusalCode
from kurt2rt.core.outcome_text import Surface
from kurt2rt.core.outcome_text import text_of as outcome_text_of
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.teaching.commands import Take
from kurt2rt.teacher.client.answer import Answer, NoAnswerError
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.page.cached_resources import CachedResources
from kurt2rt.teacher.page.control_lease import ControlLease, OperatorPresence
from kurt2rt.teacher.page.messages import (
    Hidden,
    HoldPress,
    PageCommand,
    PageHeartbeat,
    PageMessage,
    Press,
    Release,
    StopNow,
    Why,
)
from kurt2rt.teacher.page.page_connection import PageConnection, SentState
from kurt2rt.teacher.page.texts import PageNotice, text_of
from kurt2rt.teacher.page.views import answer_view, refusal_view, state_view, why_view

_POLL_S = 0.01
"""Longest delay until a silent page is noticed."""
_SILENT_S = 0.5
"""A robot without a state for so long is reported as silent, and again after each such time."""
_MOTION_S = 1.0
_OTHER_S = 3.0
"""Greatest age of the state that a command is given on: the robot's limits, for the page's own link."""
_MAX_PENDING = 8
"""Largest number of commands of one page without an answer."""


class Bridge:
    """Bridge of all open pages of one device.

    One page has control: its heartbeats tell the robot that the teacher is present, and its presses drive. Every page
    may stop the robot.
    """

    def __init__(
        self, robot: TeacherClient, device: str, robot_place: str, *, now: Callable[[], float] = anyio.current_time
    ) -> None:
        """`robot_place` is the robot's address, for texts; `now` is a monotonic clock in s."""
        self._robot = robot
        self._device = device
        self._robot_place = robot_place
        self._now = now
        self._lease = ControlLease()
        self._presence = OperatorPresence()
        self._connections: dict[int, PageConnection] = {}
        self._opened = 0
        self._answered = 0
        self._newest: State | None = None
        self._stopped_s = float("-inf")
        self._unseen_stop_due = False
        self._ended_boot: bytes | None = None
        """Start of the robot that a page has ended for the next run: it is silent, and stands."""
        self._ending_presses = 0
        self._reported_silent_s = float("-inf")
        self._tasks: anyio.abc.TaskGroup | None = None
        self._cached = CachedResources(robot, self._send_to_all, lambda: self._answered)

    async def run(self, *, task_status: anyio.abc.TaskStatus[None] = anyio.TASK_STATUS_IGNORED) -> None:
        """Follow the robot's states and poll the pages until cancelled; call it before pages connect."""
        async with anyio.create_task_group() as tasks:
            self._tasks = tasks
            self._cached.start(tasks)
            for task in (self._follow_states, self._poll_forever):
                tasks.start_soon(task)
            task_status.started()

    async def end(self) -> None:
        """End all presses before the program ends. Raises NoAnswerError if the robot does not answer the stop."""
        self._robot.watching = False
        held = [each for each in self._connections.values() if each.deadman.held]
        for connection in held:
            connection.deadman.release()
        if held:
            await self._robot.let_go()

    # Pages

    @property
    def page_count(self) -> int:
        """Number of pages that are open now."""
        return len(self._connections)

    def close_all(self) -> None:
        """Close the connections of all pages; a page that connects again has to show its cookie."""
        for connection in self._connections.values():
            connection.lost = True
            connection.wake()

    def connect(self) -> PageConnection:
        """Add a page that was opened; return its connection, from which the server sends."""
        self._opened += 1
        connection = PageConnection(self._opened)
        before = self._lease.holder
        self._connections[connection.number] = connection
        self._lease.connect(connection.number, self._now())
        self._on_lease_change(before)
        for topic, message in self._cached.messages():
            connection.send(message, topic=topic)
        return connection

    def disconnect(self, connection: PageConnection) -> None:
        """Remove a page that was closed or lost."""
        before = self._lease.holder
        self._lease.disconnect(connection.number)
        self._on_lease_change(before)
        self._release(connection)
        del self._connections[connection.number]

    def on_message(self, connection: PageConnection, message: PageMessage) -> None:
        """Handle a parsed message of a page: heartbeats, presses, stops and commands. Never waits."""
        match message:
            case PageHeartbeat():
                self._on_heartbeat(connection, message)
            case Hidden():
                connection.visible = False
                self._lease.hide(connection.number)
                if self._has_control(connection):
                    self._presence.end()
                    self._update_presence()
                self._release(connection)
            case Press() | HoldPress():
                self._on_press(connection, message)
            case Release():
                self._release(connection)
            case StopNow():
                self._stopped_s = self._now()
                for each in self._connections.values():
                    each.deadman.release()
                self._spawn(self._answer, connection, message.number, self._robot.stop)
            case Why():
                self._start(connection, message.number, self._explain)
            case PageCommand():
                self._on_command(connection, message)

    def _has_control(self, connection: PageConnection) -> bool:
        return self._lease.holder == connection.number

    def _on_heartbeat(self, connection: PageConnection, heartbeat: PageHeartbeat) -> None:
        now_s = self._now()
        connection.visible = True
        connection.heartbeat = (heartbeat.at_ms, now_s)
        self._lease.renew(connection.number, now_s)
        if heartbeat.picture is not None:
            connection.states.acknowledge(heartbeat.picture)
        if self._has_control(connection):
            self._presence.renew(connection.states.age_s(heartbeat.picture, now_s), now_s)
            self._update_presence()
        connection.wake()

    def _on_press(self, connection: PageConnection, press: Press | HoldPress) -> None:
        if self._ending_presses:
            return  # the last press has not ended yet; the next message of this press comes in 50 ms
        if not self._has_control(connection):
            _end_press_of(connection, text_of(PageNotice.NOT_IN_CONTROL))
            return
        now_s = self._now()
        age_s = connection.states.age_s(press.picture, now_s)
        if connection.deadman.is_held_by(press.press_id) and not self._robot.pressing:
            # The robot refused the press or was stopped: to go on would be a new press that the teacher did not make.
            connection.deadman.release()
            _end_press_of(connection, self._press_refusal())
        elif connection.deadman.press(press.press_id, age_s, now_s):
            if isinstance(press, HoldPress):
                self._robot.press_action(press.action)
            else:
                self._robot.press(press.left_m_s, press.right_m_s)

    def _on_command(self, connection: PageConnection, command: PageCommand) -> None:
        number = command.number
        if command.kind is not Take and not self._has_control(connection):
            connection.send(refusal_view(number, "watching", text_of(PageNotice.NOT_IN_CONTROL)))
            return
        shown = connection.states.get(command.picture)
        if shown is None or self._newest is None or shown.boot != self._newest.boot:
            connection.send(refusal_view(number, "stale", text_of(PageNotice.NO_STATE)))
        elif self._now() - shown.sent_s > (_MOTION_S if command.kind.moves else _OTHER_S):
            # The robot learns the tick of this server's newest state, so it cannot check the page's.
            connection.send(refusal_view(number, "stale", _page_text(RefusalCode.OLD_PICTURE)))
        elif command.kind.moves and shown.sent_s < self._stopped_s:
            connection.send(refusal_view(number, "stopped", _page_text(RefusalCode.STOPPED_SINCE)))
        elif command.kind is Take and self._claim_control(connection):
            connection.send({**refusal_view(number, "", text_of(PageNotice.CONTROL_TAKEN)), "accepted": True})
        else:
            self._start(connection, number, self._answer, partial(self._send, command, shown))

    async def _send(self, command: PageCommand, shown: SentState) -> Answer:
        # A lesson without a tick of its own is about the state on the page's screen.
        fields = (
            {"decision_tick": shown.tick, **command.fields}
            if hasattr(command.kind, "decision_tick")
            else command.fields
        )
        answer = await self._robot.send(command.kind, **fields)
        if answer.accepted and command.kind in (NextRunRequest, LoadRequest):  # no more states of this run come
            self._ended_boot = shown.boot
        return answer

    def _claim_control(self, connection: PageConnection) -> bool:
        """Give a page control; return whether this device is the robot's teacher already."""
        before = self._lease.holder
        self._lease.claim(connection.number, self._now())
        self._on_lease_change(before)
        return self._newest is not None and self._newest.teacher == self._device

    def _start(self, connection: PageConnection, number: int, task: Callable[..., Any], *arguments: object) -> None:
        if connection.pending >= _MAX_PENDING:
            connection.send(refusal_view(number, "busy", text_of(PageNotice.BUSY)))
        else:
            self._spawn(task, connection, number, *arguments)

    async def _answer(self, connection: PageConnection, number: int, command: Callable[[], Awaitable[Answer]]) -> None:
        async def ask() -> dict[str, Any]:
            return answer_view(number, await command())

        view = await _await_view(connection, number, ask)
        self._answered += 1
        # A list of lessons with an `after` of at least this number shows the command's lesson.
        connection.send({**view, "done": self._answered})
        if self._newest is not None:
            self._cached.update_lessons(self._newest)

    async def _explain(self, connection: PageConnection, number: int) -> None:
        async def ask() -> dict[str, Any]:
            return why_view(number, await self._robot.why(), self._cached.words)

        connection.send(await _await_view(connection, number, ask))

    # Presses and presence

    def _on_lease_change(self, before: int | None) -> None:
        if self._lease.holder != before:
            if self._lease.holder is None:
                self._presence.end()  # otherwise the first heartbeat of the new holder is on its way
                self._update_presence()
            if before in self._connections:
                self._release(self._connections[before])
        for connection in self._connections.values():
            here = self._has_control(connection)
            seat = "here" if here else "free" if self._lease.holder is None else "elsewhere"
            page = {"kind": "page", "device": self._device, "robot": self._robot_place, "seat": seat}
            connection.send(page, topic="page")

    def _release(self, connection: PageConnection) -> None:
        if connection.deadman.held:
            connection.deadman.release()
            self._ending_presses += 1
            self._spawn(self._end_press)

    def _press_refusal(self) -> str:
        refusal = self._robot.refusal
        return "" if refusal is None else refusal.text_on(Surface.PAGE) or refusal.why

    async def _end_press(self) -> None:
        self._ending_presses -= 1
        try:
            # It ends the press before its first await.
            await self._robot.let_go()
        except NoAnswerError:
            # The robot stops by itself when its teacher is silent.
            self._end_press_of_all(PageNotice.STOP_UNANSWERED)

    async def _poll_forever(self) -> None:
        while True:
            await anyio.sleep(_POLL_S)
            self.poll()

    def poll(self) -> None:
        """End the presses of silent pages, update the teacher's presence, report a silent robot."""
        now_s = self._now()
        for connection in self._connections.values():
            if connection.deadman.expired(now_s):
                self._release(connection)
                _end_press_of(connection, text_of(PageNotice.PRESS_LOST))
        self._update_presence()
        if self._robot.state_age_s > _SILENT_S and now_s - self._reported_silent_s >= _SILENT_S:
            self._reported_silent_s = now_s
            self._send_to_all({"kind": "silent", "text": self._silence_text()}, topic="silent")

    def _update_presence(self) -> None:
        present = self._presence.is_present(self._now())
        self._robot.watching = present
        if present:
            self._unseen_stop_due = True
        elif self._unseen_stop_due and self._drives_for_its_teacher():
            # The robot's own limit starts only with the last message: both times together would be too long.
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
            and not state.by_hand  # after a drive the robot stands, and after a hold a later state stops it
        )

    async def _stop_unseen(self) -> None:
        self._end_press_of_all(PageNotice.UNSEEN_STOP)
        # A robot that does not answer hears no teacher either, and stops by itself.
        with contextlib.suppress(NoAnswerError):
            await self._robot.stop()

    def _silence_text(self) -> str:
        cause = f" ({self._robot.trouble})" if self._robot.trouble else ""
        notice = PageNotice.ROBOT_ABSENT if self._newest is None else PageNotice.ROBOT_SILENT
        return text_of(notice, place=self._robot_place) + cause

    def _spawn(self, task: Callable[..., Any], *arguments: object) -> None:
        assert self._tasks is not None, "the bridge runs before a page is served"
        self._tasks.start_soon(task, *arguments)

    # The robot

    async def _follow_states(self) -> None:
        async for state in self._robot.states():
            if state.stopped is not None and (self._newest is None or state.stopped != self._newest.stopped):
                self._stopped_s = self._now()
            self._newest = state
            self._update_presence()
            self._cached.update(state, watched=bool(self._connections))
            robot, refused, words = self._robot, self._press_refusal(), self._cached.words
            view = state_view(state, robot.link, robot.state_age_s, refused, words, self._device)
            for connection in self._connections.values():
                connection.set_state(state.boot, view)

    def _send_to_all(self, message: dict[str, Any], topic: str) -> None:
        for connection in self._connections.values():
            connection.send(message, topic=topic)

    def _end_press_of_all(self, notice: PageNotice) -> None:
        for connection in self._connections.values():
            _end_press_of(connection, text_of(notice))


def _end_press_of(connection: PageConnection, text: str) -> None:
    connection.send({"kind": "let_go", "text": text}, topic="let_go")


def _page_text(code: RefusalCode) -> str:
    return outcome_text_of(Outcome(code), Surface.PAGE)


async def _await_view(
    connection: PageConnection, number: int, ask: Callable[[], Awaitable[dict[str, Any]]]
) -> dict[str, Any]:
    """Return a reply of the robot as a view, or the refusal of a robot that does not answer."""
    connection.pending += 1
    try:
        return await ask()
    except NoAnswerError as error:
        return refusal_view(number, "unknown", str(error))
    finally:
        connection.pending -= 1
