"""A teacher's device in Python: see the robot, teach it, drive it, over the network.

async with TeacherClient(Path("var/devices/phone")) as robot:
    await robot.take()
    async for state in robot.states():
        if state.cause == "unknown":
            await robot.answer("forward", of=state.tick)
"""

import time
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import AsyncExitStack, asynccontextmanager
from pathlib import Path
from types import TracebackType
from typing import Self

import anyio

from kurt2rt.channel.requests import (
    BeAtRequest,
    BehaviourRequest,
    ExportRequest,
    HealthRequest,
    HelloRequest,
    MoveWallRequest,
    PhaseRequest,
    PlaceRequest,
    PursueRequest,
    ReleaseRequest,
    ResumeRequest,
    SaveRequest,
    SeekLikeRequest,
    SeekRequest,
    SeekRlaRequest,
    SessionRequest,
    SituationsRequest,
    TakeRequest,
    WhyRequest,
    WorldRequest,
)
from kurt2rt.channel.state import State
from kurt2rt.explain.facts import DecisionFacts
from kurt2rt.explain.plain import facts_of_plain
from kurt2rt.health.plain import report_of
from kurt2rt.health.report import HealthReport
from kurt2rt.rla.rla import Phase
from kurt2rt.teaching.answer import Answer
from kurt2rt.teaching.asking import Asking, facts_of
from kurt2rt.teaching.connection import Connection, open_connection
from kurt2rt.teaching.hand import Hand
from kurt2rt.teaching.hello import Hello, hello_of
from kurt2rt.teaching.lessons import Lessons
from kurt2rt.teaching.link import Link
from kurt2rt.teaching.oscore_requests import Response
from kurt2rt.teaching.pictures import Pictures
from kurt2rt.teaching.situations import situations_of
from kurt2rt.teaching.stopping import Stopping
from kurt2rt.teaching.wheel import Wheel
from kurt2rt.teaching.world import World, world_of

ANSWER_WITHIN_S = 3.5
_SEEN_IN_CHARGE_WITHIN_S = 1.0


class TeacherClient(Lessons):
    """An async context manager: inside it pictures come, and while this device is in charge the robot is told that its
    teacher is there.

    Commands are sent again every 0.1 s, count once, and come back with the robot's `Answer`; a refusal is one, too.
    They raise NoAnswerError when nobody answered for 3.5 s: then it is not known whether they counted. A stop overtakes
    whatever else is under way. Speeds are in metres per second, ways in metres, angles in radians. One program at a
    time can use a pairing.
    """

    def __init__(
        self,
        folder: Path,
        host: str | None = None,
        port: int | None = None,
        *,
        patience_s: float = ANSWER_WITHIN_S,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        """`folder` is the device's side of a pairing; `host` and `port` of the robot are those noted there, if None.

        `patience_s` is how long an answer is waited for; `now` a monotonic clock in seconds.
        """
        self.name = folder.name
        """Of this device, and so of the teacher."""
        self._folder = folder
        self._host = host
        self._port = port
        self._patience_s = patience_s
        self._now = now
        self._pictures = Pictures(now)
        self._connection: Connection | None = None
        self._stack = AsyncExitStack()
        self._period_s: float | None = None

    async def __aenter__(self) -> Self:
        """Open the pairing and begin to observe. The robot need not be there yet. Raises CredentialsError."""
        connection = await self._stack.enter_async_context(
            open_connection(self._folder, self._host, self._port, self._pictures, self._patience_s, self._now)
        )
        self._connection, self.name = connection, connection.name
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End a press with a stop, then close."""
        # The error of the block is not shown to the task group, which would wrap it.
        await self._stack.__aexit__(None, None, None)

    # What is seen

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
    def link(self) -> Link:
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

    # Organising

    async def set_phase(self, phase: Phase) -> Answer:
        """Another training phase. In phase 5 the robot drives without its teacher, so a stop ends that command."""
        if phase is not Phase.AUTONOMOUS:
            return await self._asking.command(PhaseRequest, phase=phase)
        return await self._stopping.move("phase 5", lambda: self._asking.command(PhaseRequest, moves=True, phase=phase))

    async def pursue(self, behaviour: str) -> Answer:
        """Follow another of the behaviours that the task teaches; lessons are about it from then on."""
        # It changes where a robot goes that drives: so a stop ends it, and what was seen is what he looked at.
        return await self._stopping.move(
            behaviour, lambda: self._asking.command(PursueRequest, moves=True, behaviour=behaviour)
        )

    async def situations(self) -> tuple[str, ...]:
        """The names of the situations that have one."""
        return await self._asking.told(SituationsRequest(), lambda response: situations_of(facts_of(response)))

    async def seek(self, name: str) -> Answer:
        """Go to a situation that has a name; the robot plans the way, and says when there is none."""
        return await self._stopping.move(name, lambda: self._asking.command(SeekRequest, moves=True, name=name))

    async def seek_rla(self, rla: int) -> Answer:
        """Go to the situation that an RLA of the mid level knows."""
        return await self._stopping.move(
            f"RLA {rla}", lambda: self._asking.command(SeekRlaRequest, moves=True, rla_id=rla)
        )

    async def seek_like(self, features: Mapping[str, float], tolerance: float) -> Answer:
        """Go to any situation in which these features of the mid level have these values, give or take `tolerance`."""
        wanted = tuple(features.items())
        return await self._stopping.move(
            "a goal",
            lambda: self._asking.command(SeekLikeRequest, moves=True, features=wanted, tolerance=tolerance),
        )

    async def stop_seeking(self) -> Answer:
        """No goal any more; the mid level commands as it did before."""
        return await self._stopping.move("no goal", lambda: self._asking.command(SeekRequest, moves=True, name=None))

    async def be_at(self, name: str) -> Answer:
        """The robot was set down at a situation that has a name."""
        return await self._asking.command(BeAtRequest, name=name)

    async def begin_session(self, name: str) -> Answer:
        """Teaching begins: the teaching clock runs."""
        return await self._asking.command(SessionRequest, name=name)

    async def end_session(self) -> Answer:
        """Teaching ends."""
        return await self._asking.command(SessionRequest, name=None)

    async def take(self) -> Answer:
        """Be the teacher from now on; the robot knows that he is there when this returns."""
        answer = await self._stopping.move("take", lambda: self._asking.command(TakeRequest, moves=True))
        if answer.accepted:
            with anyio.move_on_after(_SEEN_IN_CHARGE_WITHIN_S):
                async for state in self.states():
                    if state.teacher == self.name:
                        self._hand.beat()
                        break
        return answer

    async def hand_over(self, to: str | None = None) -> Answer:
        """Be the teacher no longer; `to` is who is next, None: whoever takes it."""
        return await self._asking.command(ReleaseRequest, to=to)

    async def save(self, label: str = "") -> Answer:
        """A copy of the knowledge on the robot; its `name` and `sha256` are in `extra`."""
        return await self._asking.command(SaveRequest, label=label)

    async def export(self) -> Answer:
        """The RLAs as a readable table on the robot; `name` and `sha256` are in `extra`."""
        return await self._asking.command(ExportRequest)

    # Moving

    async def stop(self) -> Answer:
        """Stand; always allowed. A press is over, and what was to move the robot and is not answered yet is sent no
        more: it comes back refused, with the `why` "stopped".

        Raises NoAnswerError as every command does, but goes on being sent then: see `stop_pending`.
        """
        self._hand.end()
        return await self._stopping.stop()

    @property
    def stop_pending(self) -> bool:
        """Whether a stop that was not answered in time is still being sent: until it is, or until the teacher wishes
        something later, which is `resume`, `run` or the begin of a press.
        """
        return self._stopping.pending

    async def resume(self) -> Answer:
        """Drive again after a stop."""
        self._stopping.wish_anew()
        return await self._stopping.move("go", lambda: self._asking.command(ResumeRequest, moves=True))

    async def run(self, action: str, *, seconds: float) -> Answer:
        """Run one action of the repertoire for a time; the robot stands afterwards."""
        self._stopping.wish_anew()

        async def begin() -> Answer:
            if self._period_s is None:
                self._period_s = (await self.hello()).period_s
            ticks = round(seconds / self._period_s)
            return await self._asking.command(BehaviourRequest, moves=True, action=action, ticks=ticks)

        return await self._stopping.move(action, begin)

    @property
    def watching(self) -> bool:
        """Whether the teacher looks at the robot; only then is it told that he is there."""
        return self._hand.watching

    @watching.setter
    def watching(self, watching: bool) -> None:
        self._hand.watching = watching

    @property
    def pressing(self) -> bool:
        """Whether a press is on."""
        return self._hand.pressing

    @property
    def refused(self) -> str:
        """Why the last press was not begun, or ended by itself; empty while all is well."""
        return self._hand.refused

    def press(self, left_m_s: float, right_m_s: float) -> bool:
        """Begin a press or change its speeds; whether one is on. It ends by itself when the robot refuses it, or when
        no picture came for half a second; whoever calls this again then begins another one.

        Raises WireError for speeds that no robot takes.
        """
        return self._hand.press(left_m_s, right_m_s)

    async def let_go(self) -> Answer | None:
        """End the press with a stop that ends no later one; None when none is on.

        The press is over before this waits for anything, and when nobody answers: the robot lets go by itself.
        """
        return await self._open.release(self._hand.hold)

    @asynccontextmanager
    async def driving(self) -> AsyncIterator[Wheel]:
        """Drive by hand inside the block; the press begins with the first speeds and ends with a stop."""
        wheel = Wheel(self._hand)
        try:
            yield wheel
        except BaseException:
            with anyio.CancelScope(shield=True):
                await self._open.release_anyhow(wheel.hold)
            raise
        await self._open.release(wheel.hold)

    # The simulated world

    async def move_wall(self, name: str, dx: float, dy: float) -> Answer:
        """Shift a wall or an obstacle."""
        return await self._asking.command(MoveWallRequest, name=name, dx_m=dx, dy_m=dy)

    async def place(self, x: float, y: float, heading: float) -> Answer:
        """Put the robot down elsewhere."""
        return await self._asking.command(PlaceRequest, x_m=x, y_m=y, heading_rad=heading)

    # How it works

    @property
    def _asking(self) -> Asking:
        return self._open.asking

    @property
    def _stopping(self) -> Stopping:
        return self._open.stopping

    @property
    def _hand(self) -> Hand:
        return self._open.hand

    @property
    def _open(self) -> Connection:
        if self._connection is None:
            raise RuntimeError("the client is not open; use it as: async with TeacherClient(folder) as robot: ...")
        return self._connection
