"""Plan of the phases study."""

from pathlib import Path

import pytest

from hal.robot_settings import load_robot
from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.phases.steps import Step
from kurt2rt.experiments.phases.study import JobOutcome, PhasesTask, StepJob, make_plan
from kurt2rt.experiments.study.jobs import JobParts, Results, StudyJob
from kurt2rt.experiments.study.study_plan import StudyPlan
from simbridge.contracts.robot_kind import simulations_of
from tests.experiments.phases.outcomes import TASK, stage, teaching
from tests.experiments.study.here import parts_in


def planned(
    task: TaskSettings = TASK, folder: Path = Path("never-made"), *, quick: bool = False
) -> StudyPlan[PhasesTask]:
    return make_plan(task, (100, 101), parts_in(folder), quick=quick)


def step_of(job: StudyJob) -> str:
    return Path(job.stem).parent.name


def with_phases(**changed: float) -> TaskSettings:
    assert TASK.phases is not None
    return TASK.model_copy(update={"phases": TASK.phases.model_copy(update=changed)})


def test_waves_need_only_the_waves_before() -> None:
    waves = [{step_of(job) for job in wave} for wave in planned().waves]
    assert waves[0] == {Step.PHASE_2}
    place = {step: number for number, wave in enumerate(waves) for step in wave}
    assert (
        place[Step.REWARDS]
        < place[Step.PHASE_4]
        < place[Step.CRITIC_ALONE]
        == place[Step.PHASE_5]
        < place[Step.LONG_RUN]
    )
    assert all(len(wave) % 2 == 0 for wave in planned().waves)  # as many of each seed
    jobs = planned().jobs
    assert len({job.file for job in jobs}) == len(jobs) == 2 * 14


def test_random_penalties_equal_those_of_the_rewards(tmp_path: Path) -> None:
    results, jobs = Results(tmp_path), planned(folder=tmp_path).of(StepJob)
    rewards = [job for job in jobs if job.of.name == Step.REWARDS]
    for job, blame in zip(rewards, (37, 5), strict=True):
        (tmp_path / job.file).parent.mkdir(parents=True, exist_ok=True)
        stages = (stage(Step.REWARDS, taught=teaching(blame=blame)),)
        results.write(job, JobOutcome(made_of=job.made_of, seed=job.seed, stages=stages))
    told = [job.plan() for job in jobs if job.of.name == Step.BLAME_BY_CHANCE]
    assert [each.blame_by_chance for each in told if each] == [37, 5]


def test_changed_step_changes_following_steps_only() -> None:
    before = {job.file: job.made_of for job in planned().jobs}
    after = {job.file: job.made_of for job in planned(with_phases(autonomy_s=77.0)).jobs}
    changed = {Path(file).parent.name for file in before if before[file] != after[file]}
    assert changed == {Step.PHASE_5, Step.LONG_RUN}


@pytest.mark.parametrize("robot", ["school", "turtlebot"])
def test_quick_critic_of_another_robot_has_its_sensors(robot: str) -> None:
    settings, task = load_robot(robot), load_task(f"{robot}/wall_following")
    parts = JobParts(factory=simulations_of(settings), robot=settings, results=Results(Path("never-made")))
    critic = load_critic(make_plan(task, (0,), parts, quick=True).about.task.critic)
    assert critic.perception.sensors is not None
    assert critic.perception.sensors.used <= set(settings.infrared.names)
    assert critic.need.bad_share == 0.0


def test_quick_plan_shortens_intervals_and_thresholds() -> None:
    quick, whole = planned(quick=True).about.task, TASK
    assert quick.phases is not None
    assert whole.phases is not None
    assert quick.phases.signals.bad_every_s == 0.2 * whole.phases.signals.bad_every_s
    assert quick.phases.set_down_every_s == 0.2 * whole.phases.set_down_every_s
    heard, critic = load_critic(quick.critic), load_critic(whole.critic)
    assert heard.agreement.least < critic.agreement.least
    assert heard.best.window_s * 4 <= quick.phases.repair_alone_s
    assert heard.feature_hash == critic.feature_hash
