"""Services of ROS 2 by which a node teaches, stops and takes the robot: std_srvs/Trigger, one for each action."""

import asyncio
import threading
from collections.abc import Awaitable, Callable
from functools import partial
from typing import Protocol

from anyio.abc import TaskGroup

from kurt2rt.channel.protocol.hello import Hello
from kurt2rt.core.outcome_text import Surface
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.teaching.commands import Correct, HandOver, Resume, Take, Teach, Undo
from kurt2rt.ros.port import RosConnectionError, RosPort
from kurt2rt.ros.settings import is_ros_name
from kurt2rt.ros.topic import Topic, trigger_service
from kurt2rt.teacher.client.answer import Answer, NoAnswerError
from kurt2rt.teacher.client.client import TeacherClient

MOST_REQUESTS = 16
"""Requests under way; more are refused at once, but a stop is not."""

Work = Callable[[], Awaitable[Answer]]


class Request(Protocol):
    """Call of a ROS 2 service that waits for its answer, to be given once, from any thread."""

    def respond(self, success: bool, text: str) -> None:
        """Answer the caller of the service. Raises RosConnectionError."""
        ...


class RosServer(RosPort, Protocol):
    """Connection to ROS 2 on which services can be offered, besides topics."""

    def serve(self, service: Topic, on_request: Callable[[Request], None]) -> None:
        """Call `on_request` with each request, in a thread of the connection. Raises RosConnectionError."""
        ...


class Services:
    """ROS 2 services of one robot, such as stop, take and an action each, carried out as commands.

    Each request gets a task of its own in the loop, so that a stop overtakes the others.
    """

    def __init__(self, robot: TeacherClient, port: RosServer, tasks: TaskGroup) -> None:
        """Work in `tasks`, in the running loop."""
        self._robot, self._port, self._tasks = robot, port, tasks
        self._loop = asyncio.get_running_loop()
        self._waiting: asyncio.Queue[tuple[Work, Request]] = asyncio.Queue()
        self._lock = threading.Lock()
        self._under_way = 0
        self._offered: set[str] = set()

    def offer(self, hello: Hello) -> list[str]:
        """Offer the services that are missing for a robot; return actions that no service can be named after.

        Raises RosConnectionError if the connection is closed.
        """
        self._serve("stop", self._robot.stop, always=True)
        for kind in (Resume, Take, HandOver, Undo):
            self._serve(kind.path.strip("/"), partial(self._robot.send, kind))
        unnamed = []
        for action in hello.actions:
            if is_ros_name(action):
                self._serve(f"teach/{action}", partial(self._teach, action))
                self._serve(f"correct/{action}", partial(self._correct, action))
            else:
                unnamed.append(action)
        return unnamed

    async def work(self) -> None:
        """Begin each request as it comes; runs until cancelled."""
        while True:
            work, request = await self._waiting.get()
            self._tasks.start_soon(self._handle, work, request)

    async def _teach(self, action: str) -> Answer:
        """Answer the question of the newest state. Raises NoAnswerError, and ValueError if the mid level asks."""
        state = self._robot.state
        if state is not None and state.asks_at == MID and state.standing.asks:
            raise ValueError("the mid level asks for a way, and services teach actions alone; answer on the page")
        return await self._robot.send(Teach, action=action, decision_tick=None if state is None else state.tick)

    async def _correct(self, action: str) -> Answer:
        """Correct the decision of the newest state. Raises NoAnswerError."""
        state = self._robot.state
        return await self._robot.send(Correct, action=action, decision_tick=None if state is None else state.tick)

    def _serve(self, name: str, work: Work, *, always: bool = False) -> None:
        """Offer a service once; `always`: also while many requests are under way."""
        if name in self._offered:
            return
        self._offered.add(name)

        def on_request(request: Request) -> None:
            with self._lock:
                busy = self._under_way >= MOST_REQUESTS and not always
                self._under_way += not busy
            if busy:
                request.respond(False, "too many requests are under way; wait for their answers")
            else:
                self._loop.call_soon_threadsafe(self._waiting.put_nowait, (work, request))

        self._port.serve(trigger_service(name), on_request)

    async def _handle(self, work: Work, request: Request) -> None:
        try:
            answer = await work()
            success, text = answer.accepted, answer.text_on(Surface.LOG) or answer.why or "done"
        except (NoAnswerError, ValueError) as error:
            success, text = False, str(error)
        finally:
            with self._lock:
                self._under_way -= 1
        try:
            request.respond(success, text)
        except RosConnectionError:
            return  # the caller is gone; the robot has done what was asked
