"""Plan of the phases study: every step of every robot as a job, in waves."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from hal.robot_settings import RobotSettings
from kurt2rt.core.critic.settings import CriticSettings
from kurt2rt.core.critic.sides import critic_of
from kurt2rt.core.reinforcement.settings import AutonomousValues
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.compatibility import require_course
from kurt2rt.experiments.phases.jobs import FirstPhasesJob, Job, StepJob
from kurt2rt.experiments.phases.steps import PHASE_2, PhaseStep, phases_of, steps_of
from kurt2rt.experiments.study.jobs import JobParts, StudyJob
from kurt2rt.experiments.study.loop_choice import ALL_ON_BUS, NO_CHOICE, LoopChoice, RequestedLoops, choose_loops
from kurt2rt.experiments.study.provenance import Fingerprints, Provenance

_QUICK_TEACHING_S, _QUICK_EXAM_S, _QUICK_STEP_S, _QUICK_ALONE_S = 40.0, 6.0, 10.0, 40.0
_QUICK_SHARE = 0.2
"""Factor of the intervals in a quick run."""


class _RobotParts(JobParts):
    task: TaskSettings
    seed: int


@dataclass(frozen=True, slots=True)
class PhasesPlan:
    """Jobs of the study."""

    task: TaskSettings
    seeds: tuple[int, ...]
    quick: bool
    """A part only."""
    steps: tuple[tuple[Job, ...], ...]
    """Jobs in waves; the jobs of a wave need only results of earlier waves."""
    choice: LoopChoice = NO_CHOICE
    """Loops of the jobs."""

    @property
    def jobs(self) -> list[Job]:
        """Jobs of all waves, in order, without witnesses."""
        return [job for wave in self.steps for job in wave]

    @property
    def waves(self) -> tuple[tuple[StudyJob, ...], ...]:
        """Jobs and their witnesses in waves."""
        return tuple((*wave, *self.choice.witnesses(wave)) for wave in self.steps)


def make_plan(
    task: TaskSettings,
    seeds: Sequence[int],
    parts: JobParts,
    *,
    quick: bool = False,
    loops: RequestedLoops = ALL_ON_BUS,
) -> PhasesPlan:
    """Check task and worlds, and return the jobs.

    Args:
        task: with a section on phases.
        seeds: one robot each.
        parts: factory, robot and results of the jobs.
        quick: all steps, each so short that it says nothing but that everything works.
        loops: requested for lessons and exams; the lessons of phases 3 to 5 are given on the CAN bus.

    Raises:
        hal.settings.SettingsError: the task has no such section, or does not fit a world.
    """
    factory, robot, results = parts["factory"], parts["robot"], parts["results"]
    if quick:
        task = _shortened(task, robot)
    steps = tuple(steps_of(task))
    worlds = (task.teaching.world, *task.exam.worlds, *phases_of(task).repair_worlds)
    factory.require_worlds(*worlds)
    require_course(factory, task, worlds)
    # What is long enough for one step decides nothing of another: each is made of the steps that lead to it.
    fingerprints = Fingerprints(factory, robot, ("paper", "plain", "phases"))
    critic = critic_of(task.critic, robot).model_dump_json()
    by_name = {step.name: step for step in steps}

    def made_of(step: PhaseStep | None) -> Provenance:
        way = "\n".join(map(repr, _way_to(step, by_name)))
        return fingerprints.of(task, worlds, critic, way)

    made = {name: made_of(step) for name, step in by_name.items()}
    made_first = made_of(None)
    waves: list[list[Job]] = [[] for _ in range(1 + max(_depth(step, by_name) for step in steps))]
    for seed in seeds:
        common = _RobotParts(factory=factory, robot=robot, task=task, seed=seed, results=results)
        first = FirstPhasesJob(**common, made_of=made_first)
        waves[0].append(first)
        jobs: dict[str, Job] = {PHASE_2: first}
        for step in steps:
            jobs[step.name] = job = StepJob(
                **common,
                of=step,
                before=jobs[step.after],
                first=first,
                alike=jobs.get(step.blames_like),
                made_of=made[step.name],
            )
            waves[_depth(step, by_name)].append(job)
    choice = choose_loops([job for wave in waves for job in wave], loops, robot)
    return PhasesPlan(task, tuple(seeds), quick, tuple(map(choice.apply, waves)), choice)


def _way_to(step: PhaseStep | None, by_name: dict[str, PhaseStep]) -> Iterator[PhaseStep]:
    """Yield all steps that lead to a step, and the step itself."""
    if step is not None:
        for name in step.needs:
            yield from _way_to(by_name.get(name), by_name)
        yield step


def _depth(step: PhaseStep, by_name: dict[str, PhaseStep]) -> int:
    return 1 + max(0 if name == PHASE_2 else _depth(by_name[name], by_name) for name in step.needs)


def _shortened(task: TaskSettings, robot: RobotSettings) -> TaskSettings:
    share = min(1.0, _QUICK_TEACHING_S / task.teaching.duration_s)
    times = {name: float(round(getattr(task.teaching, name) * share)) for name in ("supervised_s", "corrections_s")}
    worlds = task.exam.worlds[:1]
    exam = {"worlds": worlds, "duration_s": min(task.exam.duration_s, _QUICK_EXAM_S)}
    return task.model_copy(
        update={
            "teaching": task.teaching.model_copy(update=times),
            "exam": task.exam.model_copy(update=exam),
            "phases": phases_of(task).shortened(_QUICK_STEP_S, worlds, _QUICK_ALONE_S, _QUICK_SHARE),
            "critic": _hastened(critic_of(task.critic, robot)),
            "reinforcement": task.reinforcement.model_copy(update={"alone": _near_sinking(task.reinforcement.alone)}),
        }
    )


def _near_sinking(worths: AutonomousValues) -> AutonomousValues:
    """Return values that a few rewards can withdraw."""
    names = ("first_value", "sunk_below", "well_above")
    return worths.model_copy(update={name: _QUICK_SHARE * getattr(worths, name) for name in names})


def _hastened(critic: CriticSettings) -> CriticSettings:
    """Return a critic that is trusted, measures and changes after some seconds."""
    agreement, every = critic.agreement, critic.signal_every_s
    few = max(2, round(_QUICK_SHARE * agreement.least))
    heard = {
        "bound": _QUICK_SHARE * agreement.bound,
        "least": few,
        "window": 2 * few,
        "apart_s": _QUICK_SHARE * agreement.apart_s,
    }
    return critic.model_copy(
        update={
            "agreement": agreement.model_copy(update=heard),
            "signal_every_s": every.model_copy(
                update={"bad": _QUICK_SHARE * every.bad, "good": _QUICK_SHARE * every.good}
            ),
            "need": critic.need.model_copy(update={"bad_share": 0.0, "first_s": 0.0}),
            "best": critic.best.model_copy(update={"window_s": _QUICK_ALONE_S / 8}),
        }
    )
