"""Plan of the phases study."""

from pathlib import Path

import pytest

from hal.robot_kind import simulations_of
from hal.robot_settings import load_robot
from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.phases.jobs import StepJob
from kurt2rt.experiments.phases.outcome import JobOutcome
from kurt2rt.experiments.phases.plan import PhasesPlan, make_plan
from kurt2rt.experiments.phases.steps import BLAME_BY_CHANCE, CRITIC_ALONE, LONG_RUN, PHASE_2, PHASE_4, PHASE_5, REWARDS
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.results import Results
from tests.experiments.helpers import ROBOT, STAGE
from tests.experiments.phases.outcomes import stage, teaching

TASK = load_task("wall_following")


def planned(task: TaskSettings = TASK, seeds: tuple[int, ...] = (100, 101), *, quick: bool = False) -> PhasesPlan:
    results = Results(Path("never-made"))
    return make_plan(task, seeds, JobParts(factory=STAGE, robot=ROBOT, results=results), quick=quick)


def with_phases(**changed: float) -> TaskSettings:
    assert TASK.phases is not None
    return TASK.model_copy(update={"phases": TASK.phases.model_copy(update=changed)})


def test_waves_need_only_the_waves_before() -> None:
    waves = [{job.step for job in wave} for wave in planned().steps]
    assert waves[0] == {PHASE_2}
    place = {step: number for number, wave in enumerate(waves) for step in wave}
    assert place[REWARDS] < place[PHASE_4] < place[CRITIC_ALONE] == place[PHASE_5] < place[LONG_RUN]
    assert all(len(wave) % 2 == 0 for wave in planned().waves)  # as many of each seed


def test_every_job_keeps_its_result_in_a_file_of_its_own() -> None:
    jobs = planned().jobs
    assert len({job.file for job in jobs}) == len(jobs) == 2 * 14


def test_random_penalties_equal_those_of_the_rewards(tmp_path: Path) -> None:
    results = Results(tmp_path)
    jobs = {
        (job.step, job.file): job
        for job in make_plan(TASK, (100, 101), JobParts(factory=STAGE, robot=ROBOT, results=results)).jobs
    }
    by_step = {step: [job for (name, _), job in jobs.items() if name == step] for step in (REWARDS, BLAME_BY_CHANCE)}
    for job, seed, blame in zip(by_step[REWARDS], (100, 101), (37, 5), strict=True):
        (tmp_path / job.file).parent.mkdir(parents=True, exist_ok=True)
        stages = (stage(REWARDS, taught=teaching(blame=blame)),)
        results.write(job, JobOutcome(made_of=job.made_of, seed=seed, stages=stages))
    told = [job.plan() for job in by_step[BLAME_BY_CHANCE] if isinstance(job, StepJob)]
    assert [each.blame_by_chance for each in told if each] == [37, 5]


def test_changed_step_changes_following_steps_only() -> None:
    before = {job.file: job.made_of for job in planned().jobs}
    after = {job.file: job.made_of for job in planned(with_phases(autonomy_s=77.0)).jobs}
    changed = {Path(file).parent.name for file in before if before[file] != after[file]}
    assert changed == {PHASE_5, LONG_RUN}


def test_changed_phase_4_changes_all_critics() -> None:
    before = {job.step: job.made_of for job in planned().jobs}
    after = {job.step: job.made_of for job in planned(with_phases(critic_s=77.0)).jobs}
    assert before[CRITIC_ALONE].differences(after[CRITIC_ALONE]) == ["task"]
    assert before[REWARDS] == after[REWARDS]


def test_quick_is_every_step_for_seconds() -> None:
    quick = planned(quick=True)
    assert [len(wave) for wave in quick.waves] == [len(wave) for wave in planned().waves]
    assert sum(job.robot_time_s for job in quick.jobs) < 1200


@pytest.mark.parametrize("robot", ["school", "turtlebot"])
def test_quick_critic_of_another_robot_has_its_sensors(robot: str) -> None:
    settings, task = load_robot(robot), load_task(f"{robot}/wall_following")
    parts = JobParts(factory=simulations_of(settings), robot=settings, results=Results(Path("never-made")))
    critic = load_critic(make_plan(task, (0,), parts, quick=True).task.critic)
    assert critic.perception.sensors is not None
    assert critic.perception.sensors.used <= set(settings.infrared.names)
    assert critic.need.bad_share == 0.0


def test_quick_plan_shortens_intervals_and_thresholds() -> None:
    quick, whole = planned(quick=True).task, TASK
    assert quick.phases is not None
    assert whole.phases is not None
    assert quick.phases.signals.bad_every_s == 0.2 * whole.phases.signals.bad_every_s
    assert quick.phases.set_down_every_s == 0.2 * whole.phases.set_down_every_s
    heard, critic = load_critic(quick.critic), load_critic(whole.critic)
    assert heard.agreement.least < critic.agreement.least
    assert heard.best.window_s * 4 <= quick.phases.repair_alone_s
    assert heard.feature_hash == critic.feature_hash
