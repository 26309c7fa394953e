"""The page about Gymnasium says what the environments have."""

import re
import runpy
import sys
from pathlib import Path

import numpy as np
import pytest
from gymnasium.spaces import Box

from kurt2rt.core.task_settings import load_task
from kurt2rt.gym.registration import ENVIRONMENTS
from tests.gym.helpers import environment

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "python.md").read_text(encoding="utf-8")


def test_page_lists_each_environment_and_its_reward() -> None:
    rows = re.findall(r"^\| `(kurt2rt/\w+-v0)` \| `(\w+)` \| (\w+) \|$", PAGE, re.MULTILINE)
    sources = {True: "teacher", False: "judge"}
    assert rows == [(name, task, sources[load_task(task).judge is None]) for name, task in ENVIRONMENTS.items()]


def test_page_lists_each_value_with_its_bounds() -> None:
    with environment() as env:
        names, space = env.observation_names, env.observation_space
    assert isinstance(space, Box)
    rows = re.findall(r"^\| (\d+)(?: to |, )(\d+) \| (.+) \| .+ \| (-?\d+) \| (-?\d+) \|$", PAGE, re.MULTILINE)
    assert [int(first) for first, *_ in rows] == [1, *(int(last) + 1 for _, last, *_ in rows[:-1])]
    assert int(rows[-1][1]) == len(names)
    for first, last, words, low, high in rows:
        values = slice(int(first) - 1, int(last))
        assert re.findall(r"`([^`]+)`", words)[:2] == [names[values][0], names[values][-1]]
        assert np.all(space.low[values] == float(low))
        assert np.all(space.high[values] == float(high))


@pytest.mark.deep
def test_printed_training_with_ppo_runs(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("stable_baselines3", reason="stable-baselines3 needs PyTorch: pip install stable-baselines3")
    script = DOCS / "examples" / "train_with_ppo.py"
    monkeypatch.setattr(sys, "argv", [script.name, "--steps", "1024", "--worlds", "c", "--exams", "1"])
    runpy.run_path(str(script), run_name="__main__")
    told = re.fullmatch(
        r"world c: agent [01] of 1 to the end, median reward -?\d+; teacher 1 of 1 to the end, median reward (\d+)\n",
        capsys.readouterr().out,
    )
    assert told
    assert int(told[1]) > 2000
