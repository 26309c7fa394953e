"""Copies of the robot's resources for all pages: introduction, world, lessons, situations, health, exam."""

from collections.abc import Awaitable, Callable
from functools import partial
from typing import Any

import anyio
import anyio.abc

from kurt2rt.channel.protocol.state import State
from kurt2rt.core.perception.sensor_words import NO_WORDS
from kurt2rt.teacher.client.answer import NoAnswerError
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.page.views import (
    exam_view,
    health_view,
    hello_view,
    lessons_view,
    simulation_view,
    situations_view,
    world_view,
)

_LESSONS = 10
_EXAM_TICKS = 50
"""Ticks between two requests for the progress of an exam."""
_HEALTH_TICKS = 100
"""Ticks between two reports of the robot's health."""

Publish = Callable[[dict[str, Any], str], None]
"""Sends a message of a topic to all pages."""


class CachedResource:
    """Copy of one of the robot's resources, such as the lessons, fetched again for another version."""

    def __init__(
        self,
        fetch: Callable[[], Awaitable[dict[str, Any]]],
        publish: Callable[[dict[str, Any]], None],
        pause_s: float = 0.3,
    ) -> None:
        """`fetch` asks the robot and may raise NoAnswerError; `publish` gets each copy; `pause_s` between requests."""
        self._fetch = fetch
        self._publish = publish
        self._pause_s = pause_s
        self._version: object = None
        self._due = anyio.Event()
        self.value: dict[str, Any] | None = None

    def refresh(self, version: object) -> None:
        """Fetch the resource unless the copy has this version."""
        if version != self._version:
            self._version = version
            self._due.set()

    async def run(self) -> None:
        """Fetch the resource after each `refresh` to another version, until cancelled; retry without an answer."""
        while True:
            await self._due.wait()
            self._due = anyio.Event()
            try:
                self.value = await self._fetch()
            except NoAnswerError:
                self._due.set()  # ask again after the pause
            else:
                self._publish(self.value)
            await anyio.sleep(self._pause_s)


class CachedResources:
    """Copies of the robot's resources, each fetched again when a state shows that it has changed."""

    def __init__(self, robot: TeacherClient, publish: Publish, answered: Callable[[], int]) -> None:
        """`answered` returns the number of the newest command that the robot has answered."""
        self._robot = robot
        self._answered = answered
        self._seeks = False
        self._exam_runs = False
        self.words = NO_WORDS
        """Words for the robot's sensors."""
        fetches = {
            "hello": self._fetch_hello,
            "world": self._fetch_world,
            "lessons": self._fetch_lessons,
            "situations": self._fetch_situations,
            "health": self._fetch_health,
            "exam": self._fetch_exam,
            "simulation": self._fetch_simulation,
        }
        self._resources = {
            topic: CachedResource(fetch, partial(_publish, publish, topic)) for topic, fetch in fetches.items()
        }

    def start(self, tasks: anyio.abc.TaskGroup) -> None:
        """Start to fetch all resources in tasks of the group, which must outlive this object."""
        for resource in self._resources.values():
            tasks.start_soon(resource.run)
        self._resources["hello"].refresh(b"")

    def update(self, state: State, *, watched: bool) -> None:
        """Refresh what a new state shows as changed; health and speed only while a page is open (`watched`)."""
        self._resources["hello"].refresh(state.boot)
        if state.place is not None:
            measured = state.tick // _HEALTH_TICKS if watched else 0
            self._resources["simulation"].refresh((state.boot, self._answered(), measured))
            progress = state.tick // _EXAM_TICKS if self._exam_runs else 0
            self._resources["exam"].refresh((state.boot, self._answered(), progress))
            self._resources["world"].refresh((state.boot, state.place.world_version))
        if watched:
            self._resources["health"].refresh((state.boot, state.tick // _HEALTH_TICKS))
        self.update_lessons(state)

    def update_lessons(self, state: State) -> None:
        """Refresh lessons and situations after a new state or an answered command."""
        version = (state.boot, state.lessons, state.unsaved, self._answered())
        self._resources["lessons"].refresh(version)
        if self._seeks:
            self._resources["situations"].refresh(version)

    def messages(self) -> list[tuple[str, dict[str, Any]]]:
        """Return (topic, message) of each copy, for a page that was just opened.

        Health is left out: it is old if no page was open, and the next report comes within a second.
        """
        found = ((topic, resource.value) for topic, resource in self._resources.items() if topic != "health")
        return [(topic, value) for topic, value in found if value is not None]

    async def _fetch_hello(self) -> dict[str, Any]:
        hello = await self._robot.hello()
        self._seeks = hello.seeks
        self.words = hello.sensor_words
        return hello_view(hello)

    async def _fetch_world(self) -> dict[str, Any]:
        world = await self._robot.world()
        if world is None:
            raise NoAnswerError("the robot has a place in a world, and no world")
        return world_view(world)

    async def _fetch_lessons(self) -> dict[str, Any]:
        after = self._answered()
        return {**lessons_view(await self._robot.lessons(_LESSONS)), "after": after}

    async def _fetch_situations(self) -> dict[str, Any]:
        return situations_view(await self._robot.situations())

    async def _fetch_exam(self) -> dict[str, Any]:
        status = await self._robot.exam()
        if status is None:
            raise NoAnswerError("the robot has a place in a world, and no exam")
        self._exam_runs = status.running
        return exam_view(status)

    async def _fetch_simulation(self) -> dict[str, Any]:
        simulation = await self._robot.simulation()
        if simulation is None:
            raise NoAnswerError("the robot has a place in a world, and its simulation is another process")
        return simulation_view(simulation)

    async def _fetch_health(self) -> dict[str, Any]:
        return health_view(await self._robot.health())


def _publish(publish: Publish, topic: str, message: dict[str, Any]) -> None:
    publish(message, topic)
