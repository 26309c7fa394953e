"""Supervision of a simulated robot in a task of several behaviours: select each in turn, free a robot that is stuck."""

import math
import random
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import suppress

from kurt2rt.channel.protocol.requests import PlaceRequest
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.commands import Pursue
from kurt2rt.teacher.client.answer import NoAnswerError
from kurt2rt.teacher.client.client import TeacherClient
from simbridge.contracts.simulation import SimulatedPlace

EACH_S = 30.0
"""Time for each behaviour: enough for one or two junctions."""
_REPEAT_S = 1.0
_MAX_PLACES = 50


class BehaviourCycler:
    """Choice of the behaviour that a scripted teacher teaches next, each for a time, in turn.

    A task of one behaviour needs no command.
    """

    def __init__(self, behaviours: Sequence[str], period_s: float) -> None:
        """Start with the behaviour that the robot follows in the first state; `period_s` is the length of a tick."""
        self.selected: str | None = None
        """None before the first state."""
        self._behaviours = tuple(behaviours)
        self._each_ticks = round(EACH_S / period_s)
        self._repeat_ticks = round(_REPEAT_S / period_s)
        self._elapsed = self._tick = 0
        self._commanded_at: int | None = None

    def update(self, state: State, *, stopped: bool) -> bool:
        """Take a state; return whether to command `selected` now.

        A command that was lost or refused is due again after a second. No time passes while a person has `stopped` the
        robot.
        """
        if self.selected is None:
            self.selected = state.behaviour if state.behaviour in self._behaviours else self._behaviours[0]
            self._tick = state.tick
        passed, self._tick = state.tick - self._tick, state.tick
        if stopped:
            return False
        self._elapsed += passed
        if self._elapsed >= self._each_ticks:
            self._elapsed = 0
            self._commanded_at = None
            self.selected = self._behaviours[(self._behaviours.index(self.selected) + 1) % len(self._behaviours)]
        if state.behaviour == self.selected:
            return False
        if self._commanded_at is not None and state.tick < self._commanded_at + self._repeat_ticks:
            return False
        self._commanded_at = state.tick
        return True


class RobotRepositioner:
    """Detector of a robot without progress, to be set down at a place that it passed before."""

    def __init__(self, after_s: float, least_m: float, period_s: float, chance: random.Random) -> None:
        """Reposition a robot that moved at most `least_m` in `after_s`, longer in a slow lesson.

        `period_s` is the length of a tick.
        """
        self._after_ticks = round(after_s / period_s)
        self._least_m = least_m
        self._chance = chance
        self._passed: deque[SimulatedPlace] = deque(maxlen=_MAX_PLACES)
        self._from: SimulatedPlace | None = None
        self._since = 0
        self._clean = True
        """Without a collision since `_from`."""

    def update(self, state: State, *, waits: bool) -> SimulatedPlace | None:
        """Process a state; return the place to put the robot now, if it made no progress; None if it shall stay.

        Time in which the robot `waits` for its teacher does not count. A place counts as passed if the robot came there
        without a collision.
        """
        place = state.place
        if place is None:
            return None
        if self._from is None:
            if not self._passed:  # after a repositioning, this state may still show the place where it was stuck
                self._passed.append(place)
            self._begin(place, state.tick)
            return None
        self._clean = self._clean and place.collisions == self._from.collisions
        if _distance_m(place, self._from) > self._least_m:
            if self._clean:
                self._passed.append(place)
            self._begin(place, state.tick)
        elif waits:
            self._begin(place, state.tick)
        elif (state.tick - self._since) * state.speed_share >= self._after_ticks:
            self._from = None  # the next state gives the new start
            return self._choose(place)
        return None

    def _begin(self, place: SimulatedPlace, tick: int) -> None:
        self._from, self._since, self._clean = place, tick, True

    def _choose(self, here: SimulatedPlace) -> SimulatedPlace:
        places = [each for each in self._passed if _distance_m(each, here) > self._least_m]
        return self._chance.choice(places or list(self._passed))


def _distance_m(one: SimulatedPlace, other: SimulatedPlace) -> float:
    return math.hypot(one.x_m - other.x_m, one.y_m - other.y_m)


class ScriptedSupervisor:
    """Selection of behaviours and repositioning of the robot, each reported in a line; idle for one behaviour."""

    def __init__(
        self, robot: TeacherClient, task: TaskSettings, period_s: float, seed: int, say: Callable[[str], None]
    ) -> None:
        """Supervise a task; `period_s` is the length of a tick, `seed` decides where the robot is put."""
        self._robot = robot
        self._task = task
        self._say = say
        self._cycler = BehaviourCycler(task.behaviours, period_s)
        self._repositioner = RobotRepositioner(
            task.teaching.rescue_after_s, task.exam.stuck_within_m, period_s, random.Random(seed)
        )

    @property
    def plan(self) -> str:
        """Plan in a sentence; empty for a task of one behaviour."""
        if len(self._task.behaviours) < 2:
            return ""
        return (
            f"{', '.join(self._task.behaviours)}: in turn, each for {EACH_S:.0f} s, because over the channel the "
            f"teacher cannot see the next junction; after {self._task.teaching.rescue_after_s:g} s without progress "
            f"the robot is put elsewhere; kurt2rt train --task {self._task.name} sees the streets, in simulated time"
        )

    async def update(self, state: State, *, stopped: bool) -> None:
        """Process a state and send the commands that it needs; none while a person has `stopped` the robot."""
        if len(self._task.behaviours) < 2:
            return
        before = self._cycler.selected
        due = self._cycler.update(state, stopped=stopped)
        selected = self._cycler.selected
        if selected != before:
            self._say(f"{selected}, for {EACH_S:.0f} s")
        place = self._repositioner.update(state, waits=stopped or not _should_move(state))
        if due and selected is not None:
            with suppress(NoAnswerError):  # the cycler repeats it after a second
                await self._robot.send(Pursue, behaviour=selected)
        if place is not None:
            self._say(await self._reposition(place))

    async def _reposition(self, place: SimulatedPlace) -> str:
        text = f"no progress for {self._task.teaching.rescue_after_s:g} s: the robot is put where it drove before"
        try:
            answer = await self._robot.send(PlaceRequest, x_m=place.x_m, y_m=place.y_m, heading_rad=place.heading_rad)
        except NoAnswerError as error:
            return f"{text}: {error}"
        return f"{text}, x {place.x_m:.2f} m, y {place.y_m:.2f} m: {answer.text}"


def _should_move(state: State) -> bool:
    """Return whether the robot is expected to make progress.

    A robot that asks or is blind is not, unless it is autonomous. A robot at a bumper or stopped by the guard is,
    because it may not come free by itself.
    """
    alone = state.cause in (DecisionCause.UNKNOWN, DecisionCause.DOUBT) and state.phase == Phase.AUTONOMOUS
    return state.action is not None or state.cause == DecisionCause.TOUCHES or state.stopped is not None or alone
