"""Guided tour: a scripted guide leads a robot that knows the streets through a town, in lockstep."""

import random
from collections import deque
from collections.abc import Callable
from typing import NamedTuple

from behaviors.metrics.errands import Errands, ErrandsSettings
from behaviors.metrics.town import Street
from config.settings import Settings, SettingsError
from hal.robot_settings import RobotSettings
from kurt2rt.core.rla.rla import BASIC, MID, Phase
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.commands import BeAt, Command, NameSituation, Pursue, Teach
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.command_checks import require_carried_out
from kurt2rt.experiments.lockstep.drive_row import Place, rounded_places
from kurt2rt.experiments.lockstep.episode import Episode
from kurt2rt.experiments.lockstep.runtimes import TrainingStore, build_training_runtime
from kurt2rt.experiments.lockstep.sensor_stop import SensorStopAct, SensorStopTimer
from kurt2rt.runtime import Runtime
from kurt2rt.teacher.scripted.basic_teacher import view_of_tick
from kurt2rt.teacher.scripted.build import build_teacher
from kurt2rt.teacher.scripted.press_times import PressTimes
from simbridge.contracts.simulation import Pose, Simulation, WorldPlan

HOME = "home"
_NAME = "scripted teacher"
_NOTICES_WITHIN_S = 3.0
"""Time from leaving a junction to the report of the robot; after it, the junction is missed."""


class TourGuide:
    """Scripted guide along a random route that prefers new ways; its input is the robot's mid level and street.

    The guide teaches each new way as an alternative, and commands a behaviour if the robot would choose another one.
    """

    def __init__(
        self, walk: Errands, names: int, times: PressTimes, *, period_s: float, seed: int, session: str
    ) -> None:
        """`walk`: tracker of the robot. `names`: number of named places. `session`, `times`: as in ScriptedTeacher."""
        self._walk = walk
        self._names = names
        self._session = session
        self._chance = random.Random(f"route of {session}, seed {seed}")
        self._times = times
        self._question_ticks = self._mistake_ticks = 0
        self._notices_within_ticks = round(_NOTICES_WITHIN_S / period_s)
        self._led: set[tuple[Street, str]] = set()
        self._to_say: deque[Command] = deque()
        self._wanted: str | None = None
        """Behaviour for the next junction; None until the robot is at a place."""
        self._waited = 0
        self._noticed = False
        self._here: Street | None = None
        self._unnoticed_ticks = 0
        self._said = 0
        self.named: dict[str, Street] = {}
        """Named places, each with its street."""
        self.missed = 0
        """Number of junctions that the robot did not notice."""

    @property
    def ways(self) -> int:
        """Number of ways from a street to the next that were taught."""
        return len(self._led)

    def begin(self) -> None:
        """Name the first place, home, and start the tour."""
        street = self._walk.street
        assert street is not None
        self.named[HOME] = street
        self._to_say.append(NameSituation(self._next_id(), _NAME, HOME))
        self._set_out()

    def set_down_at_home(self) -> None:
        """Restart the tour at home, after the robot was put there."""
        self._to_say.clear()
        self._to_say.append(BeAt(self._next_id(), _NAME, HOME))
        self._set_out()

    def watch(self, record: TickRecord) -> Command | None:
        """Return the guide's command in response to one tick; None without one. Call it on every tick."""
        mid, street = record.decision.mid, self._walk.street
        assert mid is not None
        if self._to_say:
            return self._to_say.popleft()
        if street is None and self._here is not None:
            self._here, self._noticed = None, False
        if mid.event is not None:
            self._noticed = True
        if street is None:
            return None
        if street != self._here:
            self._here, self._wanted, self._waited, self._unnoticed_ticks = street, None, 0, 0
        if not self._noticed:
            return self._command(street, driving=record.decision.driving)
        self._noticed_here(street)
        if self._wanted is None:
            return None
        if self._waited == 0:
            self._question_ticks, self._mistake_ticks = self._times.question_ticks(), self._times.mistake_ticks()
        self._waited += 1
        if mid.asks:
            if self._waited < self._question_ticks:
                return None
            self._waited = 0
            self._led.add((street, self._wanted))
            return Teach(self._next_id(), _NAME, self._wanted, level=MID)
        if self._waited < self._mistake_ticks:
            return None
        wanted = self._wanted
        if (street, wanted) not in self._led:
            self._led.add((street, wanted))
            return Teach(self._next_id(), _NAME, wanted, level=MID, alternative=True)
        if mid.behaviour == wanted:
            return None
        return Pursue(self._next_id(), _NAME, wanted)

    def _noticed_here(self, street: Street) -> None:
        if self._wanted is not None:
            return
        self._wanted = self._choose(street)
        if len(self.named) <= self._names and street not in self.named.values():
            name = f"place {len(self.named)}"
            self.named[name] = street
            self._to_say.append(NameSituation(self._next_id(), _NAME, name))

    def _choose(self, street: Street) -> str:
        town = self._walk.town
        possible = town.on_from(street)
        fresh = [each for each in possible if (street, each) not in self._led]
        if fresh:
            return self._chance.choice(fresh)
        unfinished = [each for each in town.streets if any((each, on) not in self._led for on in town.on_from(each))]
        way = town.nearest(street, self._chance.sample(unfinished, len(unfinished)))
        if way is None or len(way) < 2:
            return self._chance.choice(list(possible))
        return next(behaviour for behaviour, on in possible.items() if on == way[1])

    def _command(self, street: Street, *, driving: bool) -> Command | None:
        """Return a command if the robot did not notice a junction for too long."""
        self._unnoticed_ticks += driving
        if self._unnoticed_ticks != self._notices_within_ticks:
            return None
        self.missed += 1
        return Pursue(self._next_id(), _NAME, self._choose(street))

    def _set_out(self) -> None:
        self._here, self._wanted, self._waited = self._walk.street, None, 0
        self._noticed = True

    def _next_id(self) -> str:
        self._said += 1
        return f"{self._session}-guide-{self._said}"


class TourCounts(Settings):
    """Counts of one guided tour, which the navigation study stores."""

    teaching_s: float
    ways: int
    """Transitions from a street to the next that were taught."""
    mid_rlas: int
    basic_rlas: int
    mid_asks: int
    missed_junctions: int
    corrections: int
    """Corrections of the basic level."""
    rescues: int
    led: tuple[Place, ...]
    """Trail of the tour."""
    knowledge_hash: str


class TourResult(NamedTuple):
    """Result of a guided tour: its counts, and what the exam after it needs, such as named places."""

    counts: TourCounts
    home: Pose
    named: dict[str, Street]
    """Named places, each with the street that it is in."""
    streets: tuple[Street | None, ...]
    """Streets in the order of the tour; None where the robot was repositioned."""
    saved: Statistics


def navigation_settings(task: TaskSettings) -> ErrandsSettings:
    """Return the navigation settings of a task. Raises config.settings.SettingsError for a task without goals."""
    if isinstance(task.metric, ErrandsSettings) and task.mid is not None:
        return task.metric
    raise SettingsError(
        "to run errands it needs the metric errands, and a mid level of places", where=f"task {task.name}"
    )


def street_tracker(plan: WorldPlan, task: TaskSettings) -> Errands:
    """Return the metric that tracks a robot from street to street in a world.

    Raises config.settings.SettingsError for a task without goals, or a world without streets.
    """
    return navigation_settings(task).walk_in(plan, task.behaviours)


async def guided_tour(
    simulation: Simulation,
    settings: RobotSettings,
    task: TaskSettings,
    training: TrainingStore,
    *,
    seed: int,
    on_progress: Callable[[float], None],
) -> TourResult:
    """Lead the robot for the task's whole teaching time; its start pose is its home.

    The basic level is answered and corrected meanwhile, as in its own training run. `training`: destination of the
    lessons, and the knowledge to continue from. `seed`: of guide and teacher. `on_progress`: gets the simulated seconds
    once a second. Raises LessonLostError if the robot refused a command, and SettingsError for a task without goals.
    """
    navigation_settings(task)
    runtime = build_training_runtime(simulation, settings, task, training)
    session = f"errands-{seed}-after-{len(training.events)}"
    tour = TourRun(simulation, runtime, seed=seed, session=session, on_progress=on_progress)
    await tour.drive()
    return tour.result()


class TourRun(Episode):
    """Episode in which a scripted guide teaches the mid level, and a scripted teacher the basic one."""

    def __init__(
        self, simulation: Simulation, runtime: Runtime, *, seed: int, session: str, on_progress: Callable[[float], None]
    ) -> None:
        task, settings = runtime.task, runtime.robot
        teaching = task.teaching
        self._teacher = build_teacher(task, settings, tuple(runtime.level.repertoire), seed=seed, session=session)
        super().__init__(
            simulation,
            runtime,
            random.Random(session),
            stuck_after_s=teaching.slow_rescue_after_s,
            on_progress=on_progress,
        )
        assert isinstance(self.metric, Errands)
        self._tracker = self.metric
        names = navigation_settings(task).names
        self._guide = TourGuide(
            self.metric, names, self._teacher.times, period_s=self.period_s, seed=seed, session=session
        )
        self._home = simulation.pose
        self._unanswered_ticks = round(teaching.rescue_after_s / self.period_s)
        self._planned_ticks = round(teaching.duration_s / self.period_s)
        self._sensor_stop = SensorStopTimer(self.ticks_per_second)
        self._rescues = self._asking_ticks = 0

    async def drive(self) -> None:
        """Lead the robot for the whole teaching time."""
        self._guide.begin()
        self.send(self._teacher.begin_phase(Phase.CORRECTIONS))
        await self.run(self._planned_ticks)

    def on_tick(self, record: TickRecord) -> None:
        """Let guide and teacher react, and put a stuck robot back to its home.

        Raises LessonLostError if the robot refused a command.
        """
        require_carried_out(record, self.task, may_be_late=lambda _: self._teacher.may_be_late)
        self.measure()
        command = self._guide.watch(record)
        if command is not None:
            self.send(command)
        lesson = self._teacher.update(view_of_tick(record, touching=self.simulation.touching))
        if lesson is not None:
            self.send(lesson)
        if self.latched_ticks == self.ticks_per_second:
            self.send(self._teacher.resume())
            self.latched_ticks = 0
        act = self._sensor_stop.update(self.runtime.handler.stops.active)
        if act is SensorStopAct.RESUME:
            self.send(self._teacher.resume())
        if act is SensorStopAct.CARRY_AWAY or self._is_lost():
            self.place(self._home)
            self._guide.set_down_at_home()
            self._rescues += 1

    def _is_lost(self) -> bool:
        """Return whether the robot made no way for too long; a teacher who looks back stops that time."""
        if self.runtime.handler.stops.active is not None:
            return False
        self._asking_ticks = self._asking_ticks + 1 if self.asking else 0
        return self.is_stuck(waiting=self.asking and self._asking_ticks < self._unanswered_ticks)

    def result(self) -> TourResult:
        """Return the counters and the knowledge of the tour."""
        system = self.runtime.level.system
        counts = TourCounts(
            teaching_s=self._planned_ticks * self.period_s,
            ways=self._guide.ways,
            mid_rlas=len(system.rlas_at(MID)),
            basic_rlas=len(system),
            mid_asks=self.mid_asks,
            missed_junctions=self._guide.missed,
            corrections=self.runtime.handler.corrections_at[BASIC],
            rescues=self._rescues,
            led=rounded_places(self.trail),
            knowledge_hash=system.knowledge_hash(),
        )
        named, streets = dict(self._guide.named), tuple(self._tracker.streets)
        return TourResult(counts, self._home, named, streets, self.runtime.snapshot())
