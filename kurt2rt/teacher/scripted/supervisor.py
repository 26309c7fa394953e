"""Supervision of a simulated robot in a task of several behaviours: select each in turn, free a robot that is stuck."""

import random
from collections.abc import Callable
from contextlib import suppress

from hal.simulation import SimulatedPlace
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.teacher.client.answer import NoAnswerError
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.scripted.behaviour_cycler import EACH_S, BehaviourCycler
from kurt2rt.teacher.scripted.repositioner import RobotRepositioner


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
            f"the robot is put elsewhere; kurt2rt lesson --task {self._task.name} sees the streets, in simulated time"
        )

    async def update(self, state: State, *, stopped: bool) -> None:
        """Take a state and send the commands that it needs; a robot that a person `stopped` gets none."""
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
                await self._robot.pursue(selected)
        if place is not None:
            self._say(await self._reposition(place))

    async def _reposition(self, place: SimulatedPlace) -> str:
        text = f"no progress for {self._task.teaching.rescue_after_s:g} s: the robot is put where it drove before"
        try:
            answer = await self._robot.place(place.x_m, place.y_m, place.heading_rad)
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
