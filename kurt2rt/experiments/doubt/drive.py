"""Drive without a teacher in which the doubt of each tick is logged."""

import random
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from config.settings import SettingsError
from hal.robot_settings import RobotSettings
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.commands import Resume
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.doubt.measures import DriveLog
from kurt2rt.experiments.lockstep.episode import Episode
from kurt2rt.experiments.lockstep.exam import ExamSetup, build_exam_runtime
from kurt2rt.runtime import Runtime, RuntimeOptions
from simbridge.contracts.simulation import Simulation, SimulationFactory

_STUCK_S = 15.0
_AT_OUTLINE_M = 0.05
"""Distance from the outline at which a remembered obstacle is what the robot touches: noise, and 2 s by encoders."""
_SETTLES_S = 1.0


class DoubtResponse(StrEnum):
    """Response of the robot to its doubt, without a teacher."""

    TELLS = "only told"
    STANDS = "stands"


@dataclass(frozen=True, slots=True)
class DoubtSetup:
    """World, seed, duration and response of one drive."""

    world: str
    seed: int
    duration_s: float
    response: DoubtResponse
    set_down_after_s: float
    """Time after which a robot that asks, and gets no answer, is set down at another start; 0: it stands on."""


def with_doubt(task: TaskSettings, response: DoubtResponse) -> TaskSettings:
    """Return the task with a robot that responds so to its doubt also without a teacher.

    Raises config.settings.SettingsError if the task sets no doubt.
    """
    doubt = task.learning.doubt
    if doubt is None:
        raise SettingsError("sets no doubt", where=f"task {task.name}: learning.doubt", do="give its scales there")
    stands = response is DoubtResponse.STANDS
    doubt = doubt.model_copy(update={"asks": stands, "alone": stands})
    return task.model_copy(update={"learning": task.learning.model_copy(update={"doubt": doubt})})


async def drive(
    factory: SimulationFactory,
    settings: RobotSettings,
    task: TaskSettings,
    events: Sequence[TeachingEvent],
    setup: DoubtSetup,
    on_progress: Callable[[float], None],
) -> DriveLog:
    """Drive in the setup's world with the lessons `events` and return the log.

    `on_progress` gets the simulated seconds once a second. Raises config.settings.SettingsError if task and world do
    not fit, or the task sets no doubt.
    """
    task = with_doubt(task, setup.response)
    with closing(factory.open(setup.world, setup.seed, "doubt")) as simulation:
        exam = ExamSetup(setup.world, setup.seed, events=events)
        runtime = build_exam_runtime(simulation, settings, task, exam, RuntimeOptions())
        run = DoubtRun(simulation, runtime, setup, on_progress)
        await run.run(round(setup.duration_s / run.period_s))
        return run.log()


class DoubtRun(Episode):
    """Episode that logs doubt, missed turns and collisions."""

    def __init__(
        self, simulation: Simulation, runtime: Runtime, setup: DoubtSetup, on_progress: Callable[[float], None]
    ) -> None:
        chance = random.Random(f"doubt in world {setup.world}, seed {setup.seed}")
        super().__init__(simulation, runtime, chance, stuck_after_s=_STUCK_S, on_progress=on_progress)
        self._world = setup.world
        self._policy = runtime.task.policy.build(runtime.robot.infrared)
        meter = runtime.level.doubt
        assert meter is not None
        self._drives_on = meter.actions
        self._memory = meter.memory
        self._seen: list[bool] = []
        self._settles = round(_SETTLES_S / self.period_s)
        self._unanswered = round(setup.set_down_after_s / self.period_s)
        self._asked_ticks = 0
        self._settled_at = 0
        self._doubt: list[float] = []
        self._distance: list[float] = []
        self._driving: list[bool] = []
        self._missed: list[bool] = []
        self._collisions: list[int] = []
        self._counted = 0

    def on_tick(self, record: TickRecord) -> None:
        """Log one tick; set the robot down elsewhere if it is stuck or its question is not answered."""
        self.measure()
        decision, match = record.decision, record.decision.match
        right = self._policy.choose(record.readings.infrared_counts, record.behaviour)
        drives_on = decision.action in self._drives_on
        self._doubt.append(decision.doubt or 0.0)
        self._distance.append(0.0 if match is None else match.distance / match.radius)
        self._driving.append(decision.driving and record.tick >= self._settled_at)
        self._missed.append(drives_on and right not in self._drives_on)
        if self.simulation.collisions > self._counted:
            self._counted = self.simulation.collisions
            self._collisions.append(len(self._doubt) - 1)
            self._seen.append(self._memory is not None and self._memory.remembers_within(_AT_OUTLINE_M))
        if record.guard_result.latched:
            self.simulation.rescue()
            self.send(Resume(self.next_id("go"), "experimenter"))
        self._asked_ticks = self._asked_ticks + 1 if decision.asking else 0
        unanswered = 0 < self._unanswered <= self._asked_ticks
        if unanswered or self.is_stuck(waiting=decision.asking):
            self.reposition()
            self.runtime.reposition()
            self._asked_ticks = 0
            self._settled_at = record.tick + self._settles

    def log(self) -> DriveLog:
        """Return the log of the ticks so far."""
        return DriveLog(
            world=self._world,
            doubt=np.array(self._doubt),
            distance=np.array(self._distance),
            driving=np.array(self._driving, dtype=np.bool_),
            missed=np.array(self._missed, dtype=np.bool_),
            collisions=tuple(self._collisions),
            seen=tuple(self._seen),
            travelled_m=self.distance_travelled_m,
        )
