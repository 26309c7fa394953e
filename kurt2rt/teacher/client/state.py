"""What a teacher's device sees of its robot, and what it is told when it asks."""

from collections.abc import AsyncIterator

from kurt2rt.channel.protocol.facts_codec import facts_of_plain
from kurt2rt.channel.protocol.health import HealthReport
from kurt2rt.channel.protocol.health_codec import report_of
from kurt2rt.channel.protocol.hello import Hello, hello_of
from kurt2rt.channel.protocol.requests import HealthRequest, HelloRequest, WhyRequest, WorldRequest
from kurt2rt.channel.protocol.state import State
from kurt2rt.channel.protocol.world import World, world_of
from kurt2rt.runs.explain.facts import DecisionFacts
from kurt2rt.teacher.client.base import ClientBase
from kurt2rt.teacher.client.link_quality import LinkQuality
from kurt2rt.teacher.client.request_sender import facts_of
from kurt2rt.teacher.client.transport import Response


class StateMixin(ClientBase):
    """What is seen of the robot. What asks it raises NoAnswerError when nobody answers."""

    @property
    def state(self) -> State | None:
        """The newest picture; None before the first."""
        return self._pictures.newest

    @property
    def state_age_s(self) -> float:
        """How long ago it came; infinite before the first."""
        return self._pictures.age_s

    @property
    def restarts(self) -> int:
        """How often the robot program was found started anew since this began."""
        return self._pictures.restarts

    @property
    def link(self) -> LinkQuality:
        """How well the robot is heard."""
        return self._hand.meter.link(self._pictures.per_s)

    @property
    def trouble(self) -> str:
        """Why the robot is not heard, as far as the network tells; empty while it is."""
        return self._asking.trouble

    def states(self) -> AsyncIterator[State]:
        """Each picture as it comes, the newest first; a slow reader misses some. Ends when the client closes."""
        return self._pictures.states()

    async def hello(self) -> Hello:
        """What robot this is."""
        hello = await self._asking.told(HelloRequest(), lambda response: hello_of(facts_of(response)))
        self._pictures.hear(hello.boot, hello.tick)
        return hello

    async def health(self) -> HealthReport | None:
        """How the robot's program is; None in its first second."""

        def read(response: Response) -> HealthReport | None:
            told = facts_of(response).get("health")
            return None if told is None else report_of(told)

        return await self._asking.told(HealthRequest(), read)

    async def why(self) -> DecisionFacts | None:
        """What the robot's newest decision rested on; None before its first tick."""

        def read(response: Response) -> DecisionFacts | None:
            told = facts_of(response).get("why")
            return None if told is None else facts_of_plain(told)

        return await self._asking.told(WhyRequest(), read)

    async def world(self) -> World | None:
        """The simulated world; None where the robot is a real one."""
        return await self._asking.told(
            WorldRequest(), lambda response: None if response.code.startswith("4.04") else world_of(facts_of(response))
        )
