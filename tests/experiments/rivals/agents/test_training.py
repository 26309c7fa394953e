"""Training by stable-baselines3: equal for equal seeds, and its network decides as the agent of torch does."""

from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from kurt2rt.experiments.lockstep.learner_setting import learner_setting
from kurt2rt.experiments.rivals.agents.agent_job import AgentJob
from kurt2rt.experiments.rivals.agents.network import AgentNetwork
from kurt2rt.experiments.rivals.agents.robot_life import RobotLife
from kurt2rt.experiments.rivals.agents.rows import AGENTS
from kurt2rt.experiments.rivals.agents.training import network_of, new_agent, train
from kurt2rt.experiments.rivals.rival import Rival
from tests.experiments.helpers import ROBOT, STAGE
from tests.experiments.rivals.agents.test_agent_job import TASK, job_of, outcome_of

SETTING = learner_setting(TASK, ROBOT, seed=3913)
pytestmark = pytest.mark.deep


@pytest.fixture(autouse=True)
def _with_torch() -> None:
    for package in ("stable_baselines3", "sb3_contrib"):
        pytest.importorskip(package, reason=f"{package} needs PyTorch: pip install 'kurt2rt[rl]'")


def new_life(seed: int = 3913) -> RobotLife:
    return RobotLife(STAGE, ROBOT, TASK, seed, lambda _: None)


@pytest.mark.parametrize("name", AGENTS)
def test_equal_seeds_train_equal_agents(name: str) -> None:
    trained = []
    for seed in (1, 1, 2):
        with closing(new_life()) as life:
            trained.append(AgentNetwork(SETTING, train(name, life, 250, seed)).snapshot())
            assert life.decisions == (256 if name == "ppo" else 250)
    assert trained[0] == trained[1] != trained[2]


@pytest.mark.parametrize("name", AGENTS)
def test_network_decides_as_its_agent(name: str) -> None:
    with closing(new_life()) as life:
        agent = new_agent(name, life, 1).learn(250)
        network = network_of(name, agent)
        seen = (
            np.random.default_rng(1).uniform(-20.0, 20.0, (200, int((SETTING.weights != 0.0).sum()))).astype(np.float32)
        )
    theirs, _ = agent.predict(seen, deterministic=True)
    ours = [int(network.outputs(each).argmax()) for each in seen]
    assert ours == theirs.tolist()
    assert len(set(ours)) > 1


@pytest.mark.parametrize("name", AGENTS)
def test_job_of_an_agent_is_equal_twice(name: str, tmp_path: Path) -> None:
    outcomes = []
    for part in ("first", "second"):
        folder = tmp_path / part
        folder.mkdir()
        outcomes.append(outcome_of(job_of(folder, Rival(name, 20.0))))
    first, second = (each.model_dump(exclude=set(AgentJob.machine_times)) for each in outcomes)
    assert first == second
    assert outcomes[0].labels == (256 if name == "ppo" else 200)
