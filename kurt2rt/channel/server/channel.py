"""Teacher's channel in the robot's loop, fed after each tick."""

import secrets
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress

import anyio

from kurt2rt.channel.protocol.codec import encode_state
from kurt2rt.channel.protocol.hello import AppraisalName, Hello, MidIntroduction, SensorPlace
from kurt2rt.channel.protocol.limits import VERSION
from kurt2rt.channel.security.paired_devices import Teachers
from kurt2rt.channel.server.dependencies import ChannelDependencies
from kurt2rt.channel.server.endpoint import Endpoint, open_endpoint
from kurt2rt.channel.server.reply import done, refusal, unsaved
from kurt2rt.channel.server.request_handler import LONGEST_WAIT_S, RequestHandler
from kurt2rt.channel.server.resources import Keys, RobotSite
from kurt2rt.channel.server.state_builder import StateBuilder
from kurt2rt.core.decision.standing import ActiveStop, StopReason
from kurt2rt.core.outcome import Outcome, RefusalCode
from kurt2rt.core.perception.sensor_words import infrared_law
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.teaching.commands import HandOver, Stop
from kurt2rt.core.teaching.inbox import InboxFullError, PairingRenewed, SpeedChanged
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.writer import Acknowledgement
from kurt2rt.platform.simulated_clock import Speed
from kurt2rt.runs.explain.collect import LiveExplainer
from kurt2rt.runtime import Runtime

STATES_PER_S = 20
LOOPBACK, EVERYWHERE = "127.0.0.1", "::"
_REFRESH_S = 1.0


_KEEPS_UP = 0.9
"""Fraction of the chosen speed from which on the computer counts as fast enough for it."""


class Channel:
    """Queue of the teachers' commands for the next tick, with their outcomes and the robot's states as answers."""

    endpoint: Endpoint
    """UDP port; `open_channel` sets it."""

    def __init__(
        self,
        runtime: Runtime,
        keys: Keys,
        parts: ChannelDependencies,
        *,
        pairing_trouble: Callable[[], tuple[str, ...]] = tuple,
        longest_wait_s: float = LONGEST_WAIT_S,
    ) -> None:
        """Build the channel behind the keys; `longest_wait_s` is that of the RequestHandler, in seconds."""
        self._explainer = LiveExplainer(runtime, parts.journal.stamp_of)
        hello = describe_robot(runtime, parts.boot, simulated=parts.world is not None)
        self.handler = RequestHandler(runtime, parts, hello, why=self._explainer.facts, longest_wait_s=longest_wait_s)
        self.site = RobotSite(keys, self.handler)
        self._states = StateBuilder(runtime, parts)
        self._pairing_trouble = pairing_trouble
        self._unsaved: dict[str, Outcome] = {}
        """Outcomes of lessons that are not durable yet, by command id."""
        self._every_ticks = max(1, round(1 / (STATES_PER_S * runtime.robot.cycle_s)))
        self._speed, self._inbox = parts.speed, runtime.inbox
        self._ticks = 0

    @property
    def failures(self) -> int:
        """Number of requests that ended in an error of the program; none should."""
        return self.site.failures

    @property
    def trouble(self) -> str:
        """Faults of pairings and channel in a line; empty if there are none."""
        lines = list(self._pairing_trouble())
        failed = self.endpoint.counters.failed + self.site.failures
        if failed:
            lines.append(f"teacher's channel: {failed} failures {self.endpoint.newest_failure}".strip())
        return "; ".join(lines)

    @property
    def states_skipped(self) -> int:
        """Number of states that observers missed because the one before was still on its way."""
        return self.site.states_skipped

    def after_tick(self, record: TickRecord) -> None:
        """Answer the commands of the tick, and publish the state if it is due and a device looks. Never waits."""
        handler, tick = self.handler, record.tick
        handler.tick = tick
        for result in record.results:
            if not result.accepted:
                handler.settle(result.command_id, refusal("refused", result.outcome, tick))
            elif result.lesson:
                self._unsaved[result.command_id] = result.outcome
            else:
                # The lessons of a hold, or of a drive by hand, have an id of their own, which the outcome names.
                lesson = result.outcome.fields.get("lesson")
                handler.settle(result.command_id, done(tick, result.outcome, lesson=lesson))
        if self._speed is not None and self._speed.wanted > 1:
            self._slow_down(self._speed, record.standing.stop)
        self._states.on_tick(record)
        self._explainer.follow(record)
        self._ticks += 1
        # A faster simulation still publishes STATES_PER_S states per second of real time.
        speed = 1 if self._speed is None else max(1, round(min(self._speed.reached, self._speed.wanted)))
        if not self.site.observers:
            # A state takes as long as the tick itself.
            self.site.forget_state()
            self._states.pause()
        elif self._ticks % (self._every_ticks * speed) == 0 or self.site.waits_for_state:
            self.site.publish(encode_state(self._states.build(record)))

    def _slow_down(self, speed: Speed, stop: ActiveStop | None) -> None:
        """Return to real time if the link seemed lost because the computer cannot keep up with the chosen speed."""
        if stop is not None and stop.reason is StopReason.LINK_LOST and speed.reached < _KEEPS_UP * speed.wanted:
            speed.set(1)
            self._inbox.put(SpeedChanged(1, falls_behind=True))

    def on_acknowledged(self, acknowledgement: Acknowledgement) -> None:
        """Answer the command of a lesson that became durable, or failed to."""
        command_id, tick = acknowledgement.command_id, self.handler.tick
        outcome = self._unsaved.pop(command_id, None)
        if acknowledgement.error is None:
            if outcome is not None:
                outcome = Outcome(outcome.code, {**outcome.fields, **self.handler.lessons.fields_of(command_id)})
            reply = done(tick, outcome, row=acknowledgement.sequence, lesson=self.handler.lesson_of(command_id))
        else:
            reply = unsaved(Outcome.of(RefusalCode.NOT_SAVED, says=acknowledgement.error), tick)
        self.handler.settle(command_id, reply)


@asynccontextmanager
async def open_channel(
    runtime: Runtime, teachers: Teachers, port: int, parts: ChannelDependencies
) -> AsyncIterator[Channel]:
    """Listen for the teachers of `teachers` and yield the channel; close it at the end of the context.

    It listens on this machine only while no device is paired. Raises ChannelError if the port cannot be opened.
    """
    channel = Channel(runtime, teachers, parts, pairing_trouble=lambda: teachers.trouble)
    site = channel.site
    host = LOOPBACK if teachers.only_local else EVERYWHERE
    channel.endpoint = await open_endpoint(site, host, port, is_reachable=site.is_reachable, key_of=site.key_of)
    site.senders = channel.endpoint
    try:
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(_refresh, teachers, runtime)
            yield channel
            tasks.cancel_scope.cancel()
    finally:
        channel.handler.close()
        with anyio.CancelScope(shield=True):
            await channel.endpoint.close()


async def _refresh(teachers: Teachers, runtime: Runtime) -> None:
    """Add new pairings and drop revoked ones while the robot runs; stop the robot of a revoked teacher."""
    while True:
        await anyio.sleep(_REFRESH_S)
        for name in (await teachers.refresh()).removed:
            runtime.inbox.put(PairingRenewed(name))
            if runtime.handler.authority.teacher == name:
                revoked = f"{name}-gone-{secrets.token_hex(4)}"
                runtime.inbox.put(Stop(f"{revoked}-stop", name))
                with suppress(InboxFullError):  # the robot stands, and another device can take it
                    runtime.inbox.put(HandOver(f"{revoked}-release", name))


def describe_robot(runtime: Runtime, boot: bytes, *, simulated: bool) -> Hello:
    """Return the answer to /hello at tick 0; `boot` is the id of this start of the program.

    `simulated`: whether the robot is simulated.
    """
    robot, sensors = runtime.robot, runtime.robot.infrared.sensors
    critic = None if runtime.handler.critic is None else runtime.handler.critic.settings
    mid = None if runtime.mid is None else runtime.mid.settings
    return Hello(
        version=VERSION,
        boot=boot,
        tick=0,
        robot=robot.name,
        task=runtime.task.name,
        radius=runtime.level.system.radius,
        period_s=robot.cycle_s,
        actions=tuple(runtime.level.repertoire),
        behaviours=tuple(runtime.active_behaviour.behaviours),
        appraisals=() if critic is None else tuple(AppraisalName(each.name, each.value) for each in critic.appraisals),
        trusted_from=1.0 if critic is None else critic.agreement.bound,
        mid=None if mid is None else MidIntroduction(mid.situation.kind, len(mid.features), mid.learning.radius),
        seeks=runtime.navigator is not None,
        sensors=tuple(SensorPlace(each.name, each.label, each.x_m, each.y_m, each.heading_deg) for each in sensors),
        outline=(robot.geometry.outline_length_m, robot.geometry.outline_width_m),
        track_m=robot.geometry.effective_track_m,
        max_m_s=robot.guard.maximum_speed_m_s,
        what=runtime.task.sentence,
        law=infrared_law(robot.infrared),
        simulated=simulated,
        phases=tuple(phase.name.lower() for phase in Phase),
    )
