"""Test stand: the robot on its block, its frames, the clock and the operator."""

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from typing import Self

import anyio
from anyio.lowlevel import checkpoint

from hal.guard_reason import GuardReason
from hal.kurt2 import Kurt2
from hal.kurt2_settings import Kurt2Settings, SpeedMode
from hal.robot import STANDSTILL, GuardResult, WheelSpeeds
from kurt2rt.checks.commission.listener import FrameStatistics, Listener
from kurt2rt.checks.commission.operator import LEAVE, AbortedError, Operator, OperatorQuestion, Tone
from kurt2rt.platform.clock import Clock

RAN_AWAY = "the wheels ran away"
UNANSWERED = "a side does not turn, or its encoder counts nothing"
TURNS_SHARE = 0.1
"""Fraction of the set point at which a side turns.

Small, because encoders of another variant have a quarter of the ticks.
"""
_RUNAWAY_FACTOR, _RUNAWAY_MARGIN_M_S = 2.5, 0.1
_RUNAWAY_FRAMES = 5
_ANSWER_S = 0.7
"""Time for the wheels to reach their speed, plus 30 frames."""
_ANSWER_FRAMES = 10
_BREATH_S = 0.1
"""Time before the wheels turn, for fresh sensor readings and an idle loop."""
_IDENTITY_S = 0.25
"""Time for INFO_1, which comes every 0.1 s."""
_HALT_S = 1.5
_REST_S = 0.1


MAXIMUM_SPEED_M_S = 0.2
ACCELERATION_M_S2 = 0.5
PATIENCE_S = 0.5
"""Allowed silence of infra-red and bumpers.

With the wheels in the air they are not needed, and the checklist must find controllers with other periods.
"""


def test_stand_settings(
    robot: Kurt2Settings, mode: SpeedMode, channels: Collection[str], *, has_bumpers: bool
) -> Kurt2Settings:
    """Return the guard settings for wheel tests in a speed mode, with the received analog channels only.

    Without any channel the sensor table stays, and the guard will not let the wheels turn.
    """
    sensors = tuple(sensor for sensor in robot.infrared.sensors if sensor.channel in channels)
    limits = robot.guard
    guard = limits.model_copy(
        update={
            "maximum_speed_m_s": min(MAXIMUM_SPEED_M_S, limits.maximum_speed_m_s),
            "acceleration_m_s2": min(ACCELERATION_M_S2, limits.acceleration_m_s2),
            "stale_infrared_s": PATIENCE_S,
            "stale_bumper_s": PATIENCE_S,
            # Wheels that disobey, and boards that hang, are what the checklist looks for: it must see them at work.
            "wheel_error_m_s": 3.0,
            "frozen_infrared_s": 3600.0,
        }
    )
    return robot.model_copy(
        update={
            "can": robot.can.model_copy(update={"speed_mode": mode}),
            "guard": guard,
            "infrared": robot.infrared.model_copy(update={"sensors": sensors or robot.infrared.sensors}),
            "bumpers": robot.bumpers if has_bumpers else (),
        }
    )


@dataclass(frozen=True, slots=True)
class TestDrive:
    """Frames and times of a drive at the test stand, which ended in a brake."""

    heard: FrameStatistics
    """Frames during the drive."""
    after: FrameStatistics
    """Frames from its end to the rest."""
    applied: WheelSpeeds
    """Set points of the last frame."""
    reasons: tuple[GuardReason, ...]
    """Guard reasons of the last frame."""
    stopped_by: str | None
    """Reason of an early end."""
    rested_after_s: float | None
    """Time from the end of the drive to the rest; None if the wheels turned on or no frame came."""


class TestStand:
    """Robot, bus, clock and operator of a commissioning, for its steps: they ask, listen and drive by it.

    The robot is opened before its first motion, and braked whenever it need not move.
    """

    def __init__(
        self,
        settings: Kurt2Settings,
        open_robot: Callable[[Kurt2Settings], Kurt2],
        listener: Listener,
        clock: Clock,
        operator: Operator,
        *,
        second_guard: bool,
    ) -> None:
        """`second_guard`: start the robot's watchdog, which runs in real time."""
        self.settings = settings
        self._open_robot = open_robot
        self._listener = listener
        self._clock = clock
        self._operator = operator
        self._second_guard = second_guard
        self._robot: Kurt2 | None = None
        self._mode: SpeedMode | None = None
        self._result = GuardResult(STANDSTILL, (), latched=True)
        self._cycle_s = settings.cycle_s
        self._deadline_s = clock.now_s()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._close_robot()
        self._listener.close()

    def tell(self, text: str, tone: Tone = Tone.PLAIN) -> None:
        """Show a line of text to the operator; `tone` tells how important it is."""
        self._operator.tell(text, tone)

    async def ask(self, question: OperatorQuestion) -> str:
        """Return the operator's answer; the robot stands meanwhile.

        Raises AbortedError if the operator leaves or can give no answer, BusError.
        """
        answers: list[str] = []
        gone = False

        async def listen() -> None:
            nonlocal gone
            try:
                answers.append(await self._operator.answer(question))
            except AbortedError:
                gone = True

        async with anyio.create_task_group() as tasks:
            tasks.start_soon(listen)
            await checkpoint()  # who answers at once is not kept waiting for a tick
            while not answers and not gone:
                await self._tick(FrameStatistics(), STANDSTILL)
        if gone or answers[0] == LEAVE:
            raise AbortedError
        return answers[0]

    async def listen(self, seconds: float) -> FrameStatistics:
        """Return the frames of a time span at standstill; nothing is sent before the first motion.

        `seconds` in s. Raises BusError.
        """
        heard = FrameStatistics()
        for _ in range(self._ticks(seconds)):
            await self._tick(heard, STANDSTILL)
        return heard

    async def hardware_id(self) -> int | None:
        """Return the hardware id of INFO_1, waiting for it at standstill; None if it does not come.

        Raises BusError.
        """
        if self._listener.hardware_id is None:
            await self.listen(_IDENTITY_S)
        return self._listener.hardware_id

    async def drive(self, mode: SpeedMode, wanted: WheelSpeeds, seconds: float) -> TestDrive:
        """Turn the wheels in a speed mode for `seconds`, then brake; return the measurements.

        Brakes early if the guard stops them, if they run away, or if a driven side counts no ticks. `wanted` in m/s.
        Raises BusError.
        """
        robot = await self._prepared_robot(mode)
        return await self._brake(robot, await self._drive_steadily(robot, wanted, seconds))

    async def stop_sending(self, mode: SpeedMode, wanted: WheelSpeeds, seconds: float, silent_s: float) -> TestDrive:
        """Drive, then send no CONTROL for at most `silent_s`, until the wheels rest by themselves.

        `rested_after_s` of the result counts from the last CONTROL frame, and is None if the wheels had to be braked.
        `wanted` in m/s, times in s. Raises BusError.
        """
        robot = await self._prepared_robot(mode)
        drive = await self._drive_steadily(robot, wanted, seconds)
        if drive.stopped_by is None and self._unanswered(drive.heard, wanted):
            drive = replace(drive, stopped_by=UNANSWERED)
        if drive.stopped_by is not None:
            return await self._brake(robot, drive)
        # The second guard must sleep as well: it would take the silence for a stuck program, and brake.
        robot.watchdog.stop()
        try:
            silent = await self._until_rest(drive, silent_s, None)
            # An alarm has braked: that is not the controller's merit.
            silent = replace(silent, stopped_by=_stopped_by(robot))
        finally:
            robot.emergency_stop(GuardReason.CHECKLIST_WAITS)
            if self._second_guard:
                robot.watchdog.start()
        await self._until_rest(drive, _HALT_S, STANDSTILL)
        return silent

    async def _drive_steadily(self, robot: Kurt2, wanted: WheelSpeeds, seconds: float) -> TestDrive:
        heard = FrameStatistics()
        fastest_m_s = max(abs(wanted.left_m_s), abs(wanted.right_m_s)) * _RUNAWAY_FACTOR + _RUNAWAY_MARGIN_M_S
        stopped_by = None
        robot.release()
        for ticks in range(1, self._ticks(seconds) + 1):
            await self._tick(heard, wanted)
            stopped_by = _stopped_by(robot)
            if stopped_by is not None:
                break
            speeds = heard.wheel_speeds(self.settings, _RUNAWAY_FRAMES)
            if max(abs(speeds.left_m_s), abs(speeds.right_m_s)) > fastest_m_s:
                stopped_by = RAN_AWAY
                break
            if ticks == self._ticks(_ANSWER_S) and self._unanswered(heard, wanted):
                break  # a speed loop that hears nothing of its wheels turns them faster and faster
        return TestDrive(heard, FrameStatistics(), self._result.wheel_speeds, self._result.reasons, stopped_by, None)

    def _unanswered(self, heard: FrameStatistics, wanted: WheelSpeeds) -> bool:
        """Return whether a driven side counts too few ticks."""
        counted = heard.wheel_speeds(self.settings, _ANSWER_FRAMES)
        return any(abs(its) < TURNS_SHARE * abs(told) for its, told in zip(counted, wanted, strict=True))

    async def _brake(self, robot: Kurt2, drive: TestDrive) -> TestDrive:
        robot.emergency_stop(GuardReason.CHECKLIST_WAITS)
        return await self._until_rest(drive, _HALT_S, STANDSTILL)

    async def _until_rest(self, drive: TestDrive, at_most_s: float, wanted: WheelSpeeds | None) -> TestDrive:
        """Return the drive with the frames after it and the time of rest."""
        from_s = self._clock.now_s()
        after = FrameStatistics()
        rested_s = None
        for _ in range(self._ticks(at_most_s)):
            await self._tick(after, wanted)
            rested_s = after.rest_began_s()
            if rested_s is not None and self._clock.now_s() - rested_s >= _REST_S:
                break
        return replace(drive, after=after, rested_after_s=None if rested_s is None else max(0.0, rested_s - from_s))

    async def _prepared_robot(self, mode: SpeedMode) -> Kurt2:
        """Return the robot, opened for this mode and braked, with fresh readings."""
        if self._robot is None or self._mode is not mode:
            self._close_robot()
            listener = self._listener
            if not listener.channels:
                await self.listen(_BREATH_S)  # to hear which boards there are
            settings = test_stand_settings(self.settings, mode, listener.channels, has_bumpers=listener.has_bumpers)
            robot = self._robot = self._open_robot(settings)
            self._mode = mode
            robot.emergency_stop(GuardReason.CHECKLIST_WAITS)
            if self._second_guard:
                robot.watchdog.start()
        await self.listen(_BREATH_S)
        return self._robot

    def _close_robot(self) -> None:
        robot, self._robot = self._robot, None
        if robot is not None:
            robot.close()

    def _ticks(self, seconds: float) -> int:
        return max(1, round(seconds / self._cycle_s))

    async def _tick(self, heard: FrameStatistics, wanted: WheelSpeeds | None) -> None:
        """Run one cycle; without a set point no CONTROL is sent."""
        # Ticks that were missed are skipped, not caught up.
        self._deadline_s = max(self._deadline_s + self._cycle_s, self._clock.now_s())
        await self._clock.wait_until(self._deadline_s)
        now_s = self._clock.now_s()
        self._listener.poll(now_s, heard)
        robot = self._robot
        if robot is None:
            return
        robot.sense(now_s)
        if wanted is not None:
            self._result = robot.drive(wanted, now_s, now_s)


def _stopped_by(robot: Kurt2) -> str | None:
    """Return the reason of a latch; None without one."""
    health = robot.health
    if health.latched is None:
        return None
    return f"{health.latched} ({health.trouble})" if health.trouble else health.latched
