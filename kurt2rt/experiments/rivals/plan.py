"""Plan of a league: every rival is taught as every robot, task by task, after the policy's own drives."""

from collections.abc import Callable, Container, Sequence
from dataclasses import dataclass, replace

from hal.errors import UserError
from hal.robot_settings import RobotSettings
from hal.simulation import SimulationFactory
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.compatibility import require_course
from kurt2rt.experiments.rivals.agents.agent_job import AgentJob
from kurt2rt.experiments.rivals.holds.jobs import HeldRivalJob
from kurt2rt.experiments.rivals.jobs import PolicyJob, RivalJob
from kurt2rt.experiments.rivals.outcome import PolicyOutcome, RivalOutcome
from kurt2rt.experiments.rivals.random_questions import RandomQuestionsJob
from kurt2rt.experiments.rivals.rival import ASKS_AT_RANDOM, SHIPPED, TUNED, Rival
from kurt2rt.experiments.rivals.signals.jobs import RewardedRivalJob
from kurt2rt.experiments.rivals.tuned import TunedRivals
from kurt2rt.experiments.study.jobs import JobParts, StudyJob
from kurt2rt.experiments.study.loop_choice import ALL_ON_BUS, NO_CHOICE, LoopChoice, RequestedLoops, choose_loops
from kurt2rt.experiments.study.provenance import Fingerprints, source_hash
from kurt2rt.experiments.study.results import Results

DECIDING = (PolicyJob, RivalJob, HeldRivalJob, RewardedRivalJob, RandomQuestionsJob, AgentJob)
"""Classes whose code, and all that it imports, decides the results."""


@dataclass(frozen=True, slots=True)
class Entry:
    """Rival in one task: a job for each seed."""

    task: str
    rival: Rival
    jobs: tuple[RivalJob, ...]


@dataclass(frozen=True, slots=True)
class LeaguePlan:
    """Jobs of a league, in the order of the tables."""

    tasks: tuple[TaskSettings, ...]
    seeds: tuple[int, ...]
    after: tuple[int, ...]
    policy_jobs: tuple[PolicyJob, ...]
    entries: tuple[Entry, ...]

    left_out: tuple[str, ...] = ()
    """Sentences about rivals that take no part in a task."""
    choice: LoopChoice = NO_CHOICE
    """Loops of the jobs."""

    @property
    def rival_jobs(self) -> tuple[RivalJob, ...]:
        """Jobs of all rivals."""
        return tuple(job for entry in self.entries for job in entry.jobs)

    @property
    def waves(self) -> tuple[tuple[StudyJob, ...], ...]:
        """Jobs and their witnesses in waves; the jobs of a wave need only results of earlier waves."""
        policies, rivals = self.policy_jobs, self.rival_jobs
        return (*policies, *self.choice.witnesses(policies)), (*rivals, *self.choice.witnesses(rivals))

    def driven(self, loops: RequestedLoops, robot: RobotSettings) -> "LeaguePlan":
        """Return the plan with jobs that these loops drive. Raises hal.settings.SettingsError."""
        choice = choose_loops((*self.policy_jobs, *self.rival_jobs), loops, robot)
        return replace(
            self,
            policy_jobs=choice.apply(self.policy_jobs),
            entries=tuple(replace(each, jobs=choice.apply(each.jobs)) for each in self.entries),
            choice=choice,
        )


def make_plan(
    tasks: Sequence[TaskSettings],
    rivals: Sequence[Rival],
    seeds: Sequence[int],
    after: Sequence[int],
    parts: JobParts,
    *,
    optional: Container[Rival] = (),
    tuned: TunedRivals | None = None,
    loops: RequestedLoops = ALL_ON_BUS,
    source_of: Callable[[SimulationFactory], str] = lambda factory: source_hash(*DECIDING, type(factory)),
) -> LeaguePlan:
    """Check tasks and worlds, and return the jobs.

    Args:
        tasks: to teach, with their teachers.
        rivals: rows, each once; the RLA system as shipped is added, because all others are compared with it.
        seeds: one robot each.
        after: numbers of presses after which the robots are examined, ascending.
        parts: factory, robot and results of the jobs.
        optional: rows that are left out of a task that they cannot do; others are refused.
        tuned: settings that were found for rivals; those that are not among them keep their own.
        loops: that drive lessons and exams.
        source_of: returns the hash of the program's source.

    Raises:
        hal.settings.SettingsError: a task and a world do not fit, or a task and a rival.
        NoLearnerError: there is no such learner, or it cannot be trained.
    """
    factory = parts["factory"]
    fingerprints = Fingerprints(factory, parts["robot"], source_of(factory), ("paper", "plain", "phases"))
    rows = tuple(dict.fromkeys((Rival(SHIPPED), *rivals)))
    policies: dict[tuple[str, int], PolicyJob] = {}
    entries, left_out = [], list[str]()
    for task in tasks:
        worlds = (task.teaching.world, *task.exam.worlds)
        factory.require_worlds(*dict.fromkeys(worlds))
        require_course(factory, task, worlds)
        made = fingerprints.of(task, worlds)
        for seed in seeds:
            policies[task.name, seed] = PolicyJob(task=task, seed=seed, made_of=made, **parts)
        for row in rows:
            rival = row.tuned_by(None if tuned is None else tuned.of(task.name, row.name))
            if rival.name == TUNED and not rival.tuned:
                continue
            own, kind = rival.task(task), _job_class(rival)
            try:
                kind.require(rival, own, parts["robot"])
            except UserError as error:
                if row not in optional:
                    raise
                left_out.append(f"{task.name}: {rival.title} takes no part, because {error.what}; {error.do}")
                continue
            made = fingerprints.of(own, worlds, repr(tuple(after)), learner=rival.source)
            jobs = tuple(
                kind(
                    task=own,
                    seed=seed,
                    rival=rival,
                    after=tuple(after),
                    policy=policies[task.name, seed],
                    made_of=made,
                    **parts,
                )
                for seed in seeds
            )
            entries.append(Entry(task.name, rival, jobs))
    plan = LeaguePlan(tuple(tasks), tuple(seeds), tuple(after), tuple(policies.values()), tuple(entries))
    plan = replace(plan, left_out=tuple(left_out))
    return plan.driven(loops, parts["robot"])


def _job_class(rival: Rival) -> type[RivalJob]:
    if rival.is_agent:
        return AgentJob
    if rival.name == ASKS_AT_RANDOM:
        return RandomQuestionsJob
    if rival.is_held:
        return HeldRivalJob
    return RewardedRivalJob if rival.is_rewarded else RivalJob


@dataclass(frozen=True, slots=True)
class Row:
    """Rival in one task with its outcomes."""

    entry: Entry
    outcomes: tuple[RivalOutcome, ...]
    """One per robot, in the order of the seeds."""

    @property
    def judged(self) -> tuple[RivalOutcome, ...]:
        """Outcomes of the robots that the policy's own drives can judge."""
        return tuple(each for each in self.outcomes if each.checkpoints[-1].judged)

    def passed(self, place: int) -> int:
        """Return the number of judged robots that pass at the checkpoint of an index."""
        return sum(each.checkpoints[place].passed for each in self.judged)

    @property
    def mean_share(self) -> float:
        """Mean over all checkpoints of the share of judged robots that pass, 0 to 1."""
        places = len(self.outcomes[0].checkpoints)
        robots = len(self.judged)
        return sum(map(self.passed, range(places))) / (places * robots) if robots else 0.0


@dataclass(frozen=True, slots=True)
class League:
    """Plan and outcomes of a league."""

    plan: LeaguePlan
    policies: tuple[PolicyOutcome, ...]
    rows: tuple[Row, ...]

    def of_task(self, task: str) -> tuple[Row, tuple[Row, ...]]:
        """Return the row of the RLA system as shipped in a task of the league, and the other rows."""
        own = [row for row in self.rows if row.entry.task == task]
        shipped = next(row for row in own if row.entry.rival.name == SHIPPED)
        return shipped, tuple(row for row in own if row is not shipped)


def read_league(plan: LeaguePlan, results: Results) -> League:
    """Read the results of all jobs of the plan. Raises StudyError if a result is missing or damaged."""
    return League(
        plan,
        tuple(results.read(job, PolicyOutcome) for job in plan.policy_jobs),
        tuple(Row(entry, tuple(results.read(job, RivalOutcome) for job in entry.jobs)) for entry in plan.entries),
    )
