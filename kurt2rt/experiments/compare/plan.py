"""Plan of a comparison: every pupil is taught as every robot, task by task."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from hal.robot_settings import RobotSettings
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.compare.jobs import PupilJob, PupilOutcome
from kurt2rt.experiments.compare.pupil import SHIPPED, Pupil
from kurt2rt.experiments.lockstep.compatibility import require_course
from kurt2rt.experiments.study.jobs import JobParts, StudyJob
from kurt2rt.experiments.study.loop_choice import ALL_ON_BUS, NO_CHOICE, LoopChoice, RequestedLoops, choose_loops
from kurt2rt.experiments.study.provenance import Fingerprints
from kurt2rt.experiments.study.results import Results


@dataclass(frozen=True, slots=True)
class Entry:
    """Pupil in one task: a job for each seed."""

    task: str
    pupil: Pupil
    jobs: tuple[PupilJob, ...]


@dataclass(frozen=True, slots=True)
class ComparisonPlan:
    """Jobs of a comparison, in the order of the tables."""

    tasks: tuple[TaskSettings, ...]
    seeds: tuple[int, ...]
    after: tuple[int, ...]
    entries: tuple[Entry, ...]
    choice: LoopChoice = NO_CHOICE
    """Loops of the jobs."""

    @property
    def jobs(self) -> tuple[PupilJob, ...]:
        """Jobs of all pupils."""
        return tuple(job for entry in self.entries for job in entry.jobs)

    @property
    def waves(self) -> tuple[tuple[StudyJob, ...], ...]:
        """All jobs and their witnesses, of which none needs another."""
        return ((*self.jobs, *self.choice.witnesses(self.jobs)),)

    def driven(self, loops: RequestedLoops, robot: RobotSettings) -> "ComparisonPlan":
        """Return the plan with jobs that these loops drive. Raises hal.settings.SettingsError."""
        choice = choose_loops(self.jobs, loops, robot)
        entries = tuple(replace(each, jobs=choice.apply(each.jobs)) for each in self.entries)
        return replace(self, entries=entries, choice=choice)


def make_plan(
    tasks: Sequence[TaskSettings],
    pupils: Sequence[Pupil],
    seeds: Sequence[int],
    after: Sequence[int],
    parts: JobParts,
    *,
    loops: RequestedLoops = ALL_ON_BUS,
) -> ComparisonPlan:
    """Check tasks and worlds, and return the jobs.

    Args:
        tasks: to teach, with their teachers.
        pupils: to compare; the RLA system as shipped is added, because all others are compared with it.
        seeds: one robot each.
        after: numbers of presses after which the robots are examined, ascending.
        parts: factory, robot and results of the jobs.
        loops: that drive lessons and exams.

    Raises:
        hal.settings.SettingsError: a task and a world do not fit.
        NoLearnerError: there is no such learner.
    """
    factory, presses = parts["factory"], tuple(after)
    fingerprints = Fingerprints(factory, parts["robot"], ("paper", "plain", "phases"))
    entries = []
    for task in tasks:
        worlds = (task.teaching.world, *task.exam.worlds)
        factory.require_worlds(*dict.fromkeys(worlds))
        require_course(factory, task, worlds)
        for pupil in dict.fromkeys((Pupil(SHIPPED), *pupils)):
            made = fingerprints.of(task, worlds, repr(presses), learner=pupil.source)
            jobs = tuple(
                PupilJob(task=task, seed=seed, pupil=pupil, after=presses, made_of=made, **parts) for seed in seeds
            )
            entries.append(Entry(task.name, pupil, jobs))
    return ComparisonPlan(tuple(tasks), tuple(seeds), presses, tuple(entries)).driven(loops, parts["robot"])


@dataclass(frozen=True, slots=True)
class Row:
    """Pupil in one task with its outcomes."""

    entry: Entry
    outcomes: tuple[PupilOutcome, ...]
    """One per robot, in the order of the seeds."""

    @property
    def judged(self) -> tuple[PupilOutcome, ...]:
        """Outcomes of the robots that the policy's own drives can judge."""
        return tuple(each for each in self.outcomes if each.checkpoints[-1].judged)

    def passed(self, place: int) -> int:
        """Return the number of judged robots that pass at the checkpoint of an index."""
        return sum(each.checkpoints[place].passed for each in self.judged)


@dataclass(frozen=True, slots=True)
class Comparison:
    """Plan and outcomes of a comparison."""

    plan: ComparisonPlan
    rows: tuple[Row, ...]

    def of_task(self, task: str) -> tuple[Row, tuple[Row, ...]]:
        """Return the row of the RLA system as shipped in a task, and the other rows."""
        shipped, *others = (row for row in self.rows if row.entry.task == task)
        return shipped, tuple(others)


def read_comparison(plan: ComparisonPlan, results: Results) -> Comparison:
    """Read the results of all jobs of the plan. Raises StudyError if a result is missing or damaged."""
    rows = (Row(entry, tuple(results.read(job, PupilOutcome) for job in entry.jobs)) for entry in plan.entries)
    return Comparison(plan, tuple(rows))
