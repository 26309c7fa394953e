"""Leads a simulated robot through a task of several behaviours: one after the other, and out of where it is stuck."""

import random
from collections.abc import Callable
from contextlib import suppress

from hal.simulation import SimulatedPlace
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.decision.decision import Cause
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.teacher.client.answer import NoAnswerError
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.scripted.behaviour_cycler import EACH_S, BehaviourCycler
from kurt2rt.teacher.scripted.repositioner import RobotRepositioner


class ScriptedSupervisor:
    """Tells the robot which behaviour is wanted, and sets it down elsewhere; says each time what it does.

    A task of one behaviour needs none of it.
    """

    def __init__(
        self, robot: TeacherClient, task: TaskSettings, period_s: float, seed: int, say: Callable[[str], None]
    ) -> None:
        """`period_s`: of the robot's ticks. `seed` decides where it is set down."""
        self._robot = robot
        self._task = task
        self._say = say
        self._in_turn = BehaviourCycler(task.behaviours, period_s)
        self._setting_down = RobotRepositioner(
            task.teaching.rescue_after_s, task.exam.stuck_within_m, period_s, random.Random(seed)
        )

    @property
    def plan(self) -> str:
        """What it will do, in a sentence; empty where it has nothing to do."""
        if len(self._task.behaviours) < 2:
            return ""
        return (
            f"{', '.join(self._task.behaviours)}: in turn, each for {EACH_S:.0f} s, for over the channel nobody sees "
            f"the junction ahead; where it makes no way for {self._task.teaching.rescue_after_s:g} s the robot is set "
            f"down elsewhere; kurt2rt lesson --task {self._task.name} goes by the streets, in simulated time"
        )

    async def see(self, state: State, *, stopped: bool) -> None:
        """One picture. A robot that somebody has `stopped` is left alone."""
        if len(self._task.behaviours) < 2:
            return
        before = self._in_turn.wanted
        tell = self._in_turn.see(state, stopped=stopped)
        wanted = self._in_turn.wanted
        if wanted != before:
            self._say(f"{wanted}, for {EACH_S:.0f} s")
        elsewhere = self._setting_down.see(state, waits=stopped or not _is_to_drive(state))
        if tell and wanted is not None:
            with suppress(NoAnswerError):  # a bad link costs a second, not the session
                await self._robot.pursue(wanted)
        if elsewhere is not None:
            self._say(await self._set_down(elsewhere))

    async def _set_down(self, place: SimulatedPlace) -> str:
        what = f"no way made for {self._task.teaching.rescue_after_s:g} s: the robot is to stand where it came through"
        try:
            answer = await self._robot.place(place.x_m, place.y_m, place.heading_rad)
        except NoAnswerError as error:
            return f"{what}: {error}"
        return f"{what}, x {place.x_m:.2f} m, y {place.y_m:.2f} m: {answer.text}"


def _is_to_drive(state: State) -> bool:
    """Whether it should make way; one that asks should not, unless nobody is there who answers, nor one that is blind.

    Nor is one that touches something left to itself: it makes way when it is set down elsewhere.

    What a guard has stopped goes on as soon as it is told to, and may not come away.
    """
    alone = state.cause == Cause.UNKNOWN and state.phase == Phase.AUTONOMOUS
    return state.action is not None or state.cause == Cause.TOUCHES or state.stopped is not None or alone
