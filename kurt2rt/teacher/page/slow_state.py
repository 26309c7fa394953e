"""What the robot says rarely, for all pages: what robot it is, its world, its lessons, its places, how it is."""

from collections.abc import Callable
from functools import partial
from typing import Any

import anyio.abc

from kurt2rt.channel.protocol.state import State
from kurt2rt.core.perception.sensor_words import NO_WORDS
from kurt2rt.teacher.client.answer import NoAnswerError
from kurt2rt.teacher.page.cached_resource import CachedResource
from kurt2rt.teacher.page.robot_link import RobotLink
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
"""Between two looks at an exam that runs."""
_HEALTH_TICKS = 100
"""The robot makes a report of its health each second."""

Tell = Callable[[dict[str, Any], str], None]
"""Takes a message for all pages, and what it is about."""


class SlowState:
    """Copies of it, each fetched anew when a picture shows that it has changed."""

    def __init__(self, robot: RobotLink, tell: Tell, carried_out: Callable[[], int]) -> None:
        """`carried_out`: number of the newest order that the robot has answered."""
        self._robot = robot
        self._carried_out = carried_out
        self._seeks = False
        self._exam_runs = False
        self.words = NO_WORDS
        """For the robot's sensors."""
        fetches = {
            "hello": self._fetch_hello,
            "world": self._fetch_world,
            "lessons": self._fetch_lessons,
            "situations": self._fetch_situations,
            "health": self._fetch_health,
            "exam": self._fetch_exam,
            "simulation": self._fetch_simulation,
        }
        self._mirrors = {about: CachedResource(fetch, partial(_tell, tell, about)) for about, fetch in fetches.items()}

    def start(self, tasks: anyio.abc.TaskGroup) -> None:
        """Begin to ask, for as long as the task group lives."""
        for mirror in self._mirrors.values():
            tasks.start_soon(mirror.run)
        self._mirrors["hello"].want(b"")

    def see(self, state: State, *, watched: bool) -> None:
        """A picture came; `watched`: somebody has a page open."""
        self._mirrors["hello"].want(state.boot)
        if state.place is not None:
            measured = state.tick // _HEALTH_TICKS if watched else 0
            self._mirrors["simulation"].want((state.boot, self._carried_out(), measured))
            looks = state.tick // _EXAM_TICKS if self._exam_runs else 0
            self._mirrors["exam"].want((state.boot, self._carried_out(), looks))
            self._mirrors["world"].want((state.boot, state.place.world_version))
        if watched:
            self._mirrors["health"].want((state.boot, state.tick // _HEALTH_TICKS))
        self.see_lessons(state)

    def see_lessons(self, state: State) -> None:
        """The same of the lessons alone: an order was answered, and may have taught."""
        mark = (state.boot, state.lessons, state.unsaved, self._carried_out())
        self._mirrors["lessons"].want(mark)
        if self._seeks:
            self._mirrors["situations"].want(mark)

    def copies(self) -> list[tuple[str, dict[str, Any]]]:
        """What is there already, by what it is about, for a page that was just opened."""
        # Not health: while no page was open nobody asked for it, and within a second it comes anew.
        lasting = ((about, mirror.copy) for about, mirror in self._mirrors.items() if about != "health")
        return [(about, copy) for about, copy in lasting if copy is not None]

    async def _fetch_hello(self) -> dict[str, Any]:
        hello = await self._robot.hello()
        self._seeks = hello.seeks
        self.words = hello.sensor_words
        return hello_view(hello)

    async def _fetch_world(self) -> dict[str, Any]:
        world = await self._robot.world()
        if world is None:
            raise NoAnswerError("the robot says where it is in a world, and has none")
        return world_view(world)

    async def _fetch_lessons(self) -> dict[str, Any]:
        after = self._carried_out()
        return {**lessons_view(await self._robot.lessons(_LESSONS)), "after": after}

    async def _fetch_situations(self) -> dict[str, Any]:
        return situations_view(await self._robot.situations())

    async def _fetch_exam(self) -> dict[str, Any]:
        standing = await self._robot.exam()
        if standing is None:
            raise NoAnswerError("the robot says where it is in a world, and cannot be examined")
        self._exam_runs = standing.running
        return exam_view(standing)

    async def _fetch_simulation(self) -> dict[str, Any]:
        simulation = await self._robot.simulation()
        if simulation is None:
            raise NoAnswerError("the robot says where it is in a world, and its simulation is elsewhere")
        return simulation_view(simulation)

    async def _fetch_health(self) -> dict[str, Any]:
        return health_view(await self._robot.health())


def _tell(tell: Tell, about: str, message: dict[str, Any]) -> None:
    tell(message, about)
