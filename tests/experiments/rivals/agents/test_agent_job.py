"""An agent is a row of the league: trained for its robot life, then examined as all others."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hal.robot_settings import load_robot
from hal.settings import SettingsError
from kurt2rt.core.task_settings import load_task, taught_by_named
from kurt2rt.experiments.lockstep.learner_setting import learner_setting
from kurt2rt.experiments.rivals.agents import agent_job, training
from kurt2rt.experiments.rivals.agents.agent_job import AgentJob
from kurt2rt.experiments.rivals.agents.network import Layer, Network
from kurt2rt.experiments.rivals.agents.robot_life import RobotLife
from kurt2rt.experiments.rivals.agents.rows import AGENTS, PACKAGES
from kurt2rt.experiments.rivals.outcome import RivalOutcome
from kurt2rt.experiments.rivals.plan import make_plan
from kurt2rt.experiments.rivals.registry import NoLearnerError
from kurt2rt.experiments.rivals.rival import Rival
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.results import Results
from tests.experiments.helpers import ROBOT, STAGE, short_task
from tests.experiments.rivals.outcomes import AFTER
from tests.experiments.rivals.test_rivals_in_batch import IN_BATCH
from tests.experiments.transfer.outcomes import MADE_OF

TASK = taught_by_named(short_task(exam_s=6.0), "ordinary")
SETTING = learner_setting(TASK, ROBOT, seed=1)
FORWARD = SETTING.actions.index("forward")


def job_of(folder: Path, rival: Rival, seed: int = 3912) -> AgentJob:
    """Return the job of an agent, whose judging policy has driven."""
    parts = JobParts(factory=STAGE, robot=ROBOT, results=Results(folder))
    plan = make_plan([TASK], [], (seed,), AFTER, parts, source_of=lambda _: "tested")
    replace(plan.policy_jobs[0], loops=IN_BATCH).run(lambda _: None)
    return AgentJob(
        task=TASK,
        seed=seed,
        rival=rival,
        after=AFTER,
        policy=plan.policy_jobs[0],
        made_of=MADE_OF,
        loops=IN_BATCH,
        **parts,
    )


def outcome_of(job: AgentJob) -> RivalOutcome:
    job.run(lambda _: None)
    return job.results.read(job, RivalOutcome)


def drive_forward(_name: str, life: RobotLife, decisions: int, _seed: int) -> Network:
    """Drive a life by one action, as an agent does that learns nothing; return a network that always chooses it."""
    life.reset()
    for _ in range(decisions):
        *_, terminated, truncated, _ = life.step(np.int64(FORWARD))
        if terminated or truncated:
            life.reset()
    inputs = int((SETTING.weights != 0.0).sum())
    weights, biases = np.zeros((len(SETTING.actions), inputs)), np.eye(len(SETTING.actions))[FORWARD]
    return Network((Layer(weights.astype(np.float32), biases.astype(np.float32)),), "relu")


def test_outcome_tells_training_and_exam(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(training, "train", drive_forward)
    outcome = outcome_of(job_of(tmp_path, Rival("dqn", 12.0)))
    assert (outcome.presses, outcome.asks, outcome.corrections, outcome.driven_s) == (0, 0, 0, 0.0)
    assert (outcome.labels, outcome.teaching_s) == (120, 12.0)
    assert outcome.collisions == outcome.rescues >= 1
    assert [each.presses for each in outcome.checkpoints] == [*AFTER, 0]
    (drives,) = {each.drives for each in outcome.checkpoints}
    assert drives[0].collisions >= 1
    assert not outcome.checkpoints[-1].passed
    assert not outcome.undo_restores
    assert outcome.knowledge_bytes > 4 * 18 * 30
    assert outcome.failure == ""


def test_robot_life_is_the_lesson_unless_a_number_is_given(tmp_path: Path) -> None:
    lesson, hour = (job_of(tmp_path, Rival.parse(text)) for text in ("ppo", "ppo=3600"))
    assert (lesson.life_s, hour.life_s) == (15.0, 3600.0)
    assert hour.robot_time_s == 3606.0
    assert [lesson.stem, hour.stem] == ["ppo/wall_following-3912", "ppo-life-3600/wall_following-3912"]
    assert [job.rival.title for job in (lesson, hour)] == [
        "PPO, a lesson's time of robot life",
        "PPO, 1 h of robot life",
    ]
    assert Rival("qr-dqn", 90.0).title == "QR-DQN, 90 s of robot life"


@pytest.mark.parametrize(
    ("task", "robot", "text"),
    [
        ("streets", "kurt2", "task streets: an agent has one behaviour (got straight_on, turn_left, turn_right)"),
        ("circle", "kurt2", "task circle: an agent is trained by a judge, and the task has none"),
        ("school/fleeing", "school", "agents are trained on the KURT2 alone (got a robot of kind school)"),
    ],
)
def test_task_that_trains_no_agent_is_refused(task: str, robot: str, text: str) -> None:
    with pytest.raises(SettingsError) as refused:
        AgentJob.require(Rival("ppo"), load_task(task), load_robot(robot))
    assert text in str(refused.value)


def test_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(agent_job, "find_spec", lambda _: None)
    with pytest.raises(NoLearnerError, match=r"learner ppo: .*pip install 'kurt2rt\[rl\]'"):
        AgentJob.require(Rival("ppo"), TASK, ROBOT)


def test_agent_of_a_league_is_left_out_where_it_cannot_train(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(agent_job, "find_spec", lambda _: None)
    parts = JobParts(factory=STAGE, robot=ROBOT, results=Results(tmp_path))
    rivals = [Rival("ppo"), Rival("k-nn")]
    plan = make_plan([TASK], rivals, (3912,), AFTER, parts, optional={Rival("ppo")}, source_of=lambda _: "tested")
    assert [entry.rival.name for entry in plan.entries] == ["rla", "k-nn"]
    (said,) = plan.left_out
    assert said.startswith(f"{TASK.name}: PPO")
    assert "not installed" in said
    with pytest.raises(NoLearnerError):
        make_plan([TASK], rivals, (3912,), AFTER, parts, source_of=lambda _: "tested")
    asked_for = [*rivals, Rival("ppo", 60.0)]
    with pytest.raises(NoLearnerError):
        make_plan([TASK], asked_for, (3912,), AFTER, parts, optional={Rival("ppo")}, source_of=lambda _: "tested")


def test_robot_life_of_no_time_is_refused() -> None:
    with pytest.raises(NoLearnerError, match=r"too short \(got 0 s, allowed 1 s or more\); give ppo=SECONDS"):
        AgentJob.require(Rival("ppo", 0.0), TASK, ROBOT)


def test_agent_is_no_learner_of_lessons() -> None:
    for name in AGENTS:
        rival = Rival(name)
        assert rival.is_agent
        assert not any((rival.is_learner, rival.is_rla_system, rival.is_held, rival.is_rewarded))


def test_plan_has_a_job_for_each_agent(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(agent_job, "find_spec", lambda _: True)
    monkeypatch.setattr("kurt2rt.experiments.rivals.rival.version", lambda name: f"of {name}")
    parts = JobParts(factory=STAGE, robot=ROBOT, results=Results(tmp_path))
    plan = make_plan([TASK], [Rival("dqn"), Rival("dqn", 60.0)], (3912,), AFTER, parts, source_of=lambda _: "tested")
    jobs = [entry.jobs[0] for entry in plan.entries[1:]]
    assert all(isinstance(job, AgentJob) for job in jobs)
    assert len({job.made_of for job in jobs}) == 2
    assert all(f"{name} of {name}" in jobs[0].rival.source for name in PACKAGES)
