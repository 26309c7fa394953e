"""The teacher's channel in the robot's loop: opened beside the scheduler, fed after each tick."""

import secrets
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass, field
from typing import Any

import anyio

from hal.simulation import SimulatedWorld
from kurt2rt.channel.protocol.codec import encode_state
from kurt2rt.channel.protocol.exam_status import ExamStatus
from kurt2rt.channel.protocol.health import HealthReport
from kurt2rt.channel.protocol.requests import BOOT_BYTES, VERSION
from kurt2rt.channel.security.paired_devices import Teachers
from kurt2rt.channel.server.endpoint import Endpoint, open_endpoint
from kurt2rt.channel.server.off_tick_requests import Copies
from kurt2rt.channel.server.reply import done, refusal, unsaved
from kurt2rt.channel.server.request_handler import RequestHandler
from kurt2rt.channel.server.resources import RobotSite
from kurt2rt.channel.server.simulation import ProgressMeter, RunControl
from kurt2rt.channel.server.state_builder import JournalStatus, StateBuilder
from kurt2rt.core.outcome import Outcome, RefusalCode
from kurt2rt.core.perception.sensor_words import infrared_law
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.teaching.commands import HandOver, Stop
from kurt2rt.core.teaching.inbox import InboxFullError
from kurt2rt.core.teaching.system_events import PairingRenewed
from kurt2rt.core.tick import TickRecord
from kurt2rt.knowledge.journal.writer import Acknowledgement
from kurt2rt.platform.simulated_clock import Speed
from kurt2rt.runs.explain.live import LiveExplainer
from kurt2rt.runtime import Runtime

PICTURES_PER_S = 20
LOOPBACK, EVERYWHERE = "127.0.0.1", "::"
_REFRESH_S = 1.0


@dataclass(frozen=True, slots=True)
class ChannelDependencies:
    """What of the service the channel needs."""

    safekeeping: JournalStatus
    copies: Copies
    bus_trouble: Callable[[], str]
    ground: SimulatedWorld | None
    boot: bytes = field(default_factory=lambda: secrets.token_bytes(BOOT_BYTES))
    """Random bytes of this start."""
    health: Callable[[], HealthReport | None] = lambda: None
    """The newest report; None before the first."""
    exam: Callable[[], ExamStatus] | None = None
    """Status of the exam; None if the robot is not examined."""
    simulation: RunControl | None = None
    """None where the simulator is not in this program."""
    speed: Speed | None = None
    """None where robot time is real time."""
    measure: ProgressMeter | None = None
    """None where nothing is measured."""


class Channel:
    """Hands what teachers send to the next tick, and tells them what became of it and what the robot does."""

    def __init__(
        self,
        runtime: Runtime,
        reception: RequestHandler,
        site: RobotSite,
        telling: StateBuilder,
        endpoint: Endpoint,
        pairing_trouble: Callable[[], tuple[str, ...]],
        explaining: LiveExplainer,
        speed: Speed | None = None,
    ) -> None:
        self._reception = reception
        self._site = site
        self._telling = telling
        self._pairing_trouble = pairing_trouble
        self._explaining = explaining
        self._outcomes: dict[str, Outcome] = {}
        self._every_ticks = max(1, round(1 / (PICTURES_PER_S * runtime.robot.can.cycle_s)))
        self._speed = speed
        self._ticks = 0
        self.endpoint = endpoint

    @property
    def failures(self) -> int:
        """Requests that ended in an error of ours; none should."""
        return self._site.failures

    @property
    def trouble(self) -> str:
        """What is wrong with pairings or channel, in a line; empty when nothing is."""
        lines = list(self._pairing_trouble())
        failed = self.endpoint.counters.failed + self._site.failures
        if failed:
            lines.append(f"teacher's channel: {failed} failures {self.endpoint.newest_failure}".strip())
        return "; ".join(lines)

    @property
    def observers(self) -> int:
        """How many devices get the pictures."""
        return self._site.observers

    @property
    def pictures_skipped(self) -> int:
        """Pictures that observers did not get, because the one before was still on its way."""
        return self._site.pictures_skipped

    def after_tick(self, record: TickRecord) -> None:
        """Answer the commands that the tick took, and show the picture when it is time. Never waits."""
        reception, tick = self._reception, record.tick
        reception.tick = tick
        for result in record.results:
            if not result.accepted:
                reception.settle(result.command_id, refusal("refused", result.outcome, tick))
            elif result.lesson:
                self._outcomes[result.command_id] = result.outcome
            else:
                reception.settle(result.command_id, done(tick, result.outcome))
        self._telling.follow(record)
        self._explaining.follow(record)
        self._ticks += 1
        # As many a second of real time, at whatever speed a simulation comes to.
        speed = 1 if self._speed is None else max(1, round(min(self._speed.reached, self._speed.wanted)))
        if self._ticks % (self._every_ticks * speed) == 0:
            self._site.show(encode_state(self._telling.picture(record)))

    def settled(self, acknowledgement: Acknowledgement) -> None:
        """A lesson is durable, or never can be."""
        command_id, tick = acknowledgement.command_id, self._reception.tick
        outcome = self._outcomes.pop(command_id, None)
        if acknowledgement.error is None:
            self._reception.settle(command_id, done(tick, outcome, row=acknowledgement.sequence))
        else:
            self._reception.settle(
                command_id, unsaved(Outcome.of(RefusalCode.NOT_SAVED, says=acknowledgement.error), tick)
            )


@asynccontextmanager
async def open_channel(
    runtime: Runtime, teachers: Teachers, port: int, surroundings: ChannelDependencies
) -> AsyncIterator[Channel]:
    """Listen for the teachers of `teachers`: on this machine only while none is paired. Raises ChannelError."""
    boot = surroundings.boot
    hello = describe(runtime, boot, simulated=surroundings.ground is not None)
    stamp_of = surroundings.safekeeping.stamp_of
    explaining = LiveExplainer(runtime, stamp_of)
    reception = RequestHandler(
        runtime,
        boot,
        hello,
        stamp_of,
        surroundings.copies,
        surroundings.ground,
        health=surroundings.health,
        why=explaining.facts,
        exam=surroundings.exam,
        simulation=surroundings.simulation,
        speed=surroundings.speed,
        measure=surroundings.measure,
    )
    telling = StateBuilder(
        runtime, boot, surroundings.safekeeping, surroundings.bus_trouble, surroundings.ground, surroundings.health
    )
    site = RobotSite(teachers, reception)
    host = LOOPBACK if teachers.only_local else EVERYWHERE
    endpoint = await open_endpoint(site, host, port, hears=site.hears, key_of=site.key_of)
    site.doorkeeper = endpoint
    try:
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(_refresh, teachers, runtime)
            yield Channel(
                runtime, reception, site, telling, endpoint, lambda: teachers.trouble, explaining, surroundings.speed
            )
            tasks.cancel_scope.cancel()
    finally:
        reception.close()
        with anyio.CancelScope(shield=True):
            await endpoint.close()


async def _refresh(teachers: Teachers, runtime: Runtime) -> None:
    """New pairings are taken in and revoked ones thrown out while the robot runs; it stands when it was theirs."""
    while True:
        await anyio.sleep(_REFRESH_S)
        for name in (await teachers.refresh()).gone:
            runtime.inbox.put(PairingRenewed(name))
            if runtime.handler.authority.teacher == name:
                revoked = f"{name}-gone-{secrets.token_hex(4)}"
                runtime.inbox.put(Stop(f"{revoked}-stop", name))
                with suppress(InboxFullError):  # it stands, and whoever comes takes it
                    runtime.inbox.put(HandOver(f"{revoked}-release", name))


def describe(runtime: Runtime, boot: bytes, *, simulated: bool) -> dict[str, Any]:
    """What robot this is, for a page that has never seen one."""
    robot, sensors = runtime.robot, runtime.robot.infrared.sensors
    critic = None if runtime.handler.critic is None else runtime.handler.critic.settings
    mid = None if runtime.mid is None else runtime.mid.settings
    actions: Sequence[str] = list(runtime.level.repertoire)
    return {
        "v": VERSION,
        "boot": boot,
        "robot": robot.name,
        "task": runtime.task.name,
        "radius": runtime.level.system.radius,
        "period_s": robot.can.cycle_s,
        "actions": actions,
        "behaviours": list(runtime.active_behaviour.behaviours),
        "appraisals": [] if critic is None else [[each.name, each.value] for each in critic.appraisals],
        "trusted_from": 1.0 if critic is None else critic.agreement.bound,
        "mid": None if mid is None else [mid.situation.kind, len(mid.features), mid.learning.radius],
        "seeks": runtime.navigator is not None,
        "sensors": [[each.name, each.label, each.x_m, each.y_m, each.heading_deg] for each in sensors],
        "outline": [robot.geometry.outline_length_m, robot.geometry.outline_width_m],
        "max_m_s": robot.guard.maximum_speed_m_s,
        "what": runtime.task.sentence,
        "law": list(infrared_law(robot.infrared)),
        "simulated": simulated,
        "phases": {int(phase): phase.name.lower() for phase in Phase},
    }
