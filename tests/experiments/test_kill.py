"""The program is killed in the middle of lessons, over and over, and no acknowledged lesson is lost."""

import random
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

from kurt2rt.knowledge.journal.fold import check_knowledge
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import read_lessons
from tests.experiments.helpers import ROBOT
from tests.experiments.teach_until_killed import eager_task

LONGEST_LIFE_S = 1.5
"""Longer than a child needs to start, so that some die young and some in their lessons."""


def teach_and_kill(knowledge: Path, chance: random.Random) -> list[str]:
    """Let a child teach, kill it, and return what it said was acknowledged."""
    command = [sys.executable, "-m", "tests.experiments.teach_until_killed", str(knowledge), str(chance.randint(0, 9))]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None
        assert child.stderr is not None
        said: list[str] = []
        if chance.random() < 0.3:  # at any moment of its life
            try:
                child.wait(timeout=chance.uniform(0.0, LONGEST_LIFE_S))
            except subprocess.TimeoutExpired:
                child.kill()
        else:
            said += [child.stdout.readline() for _ in range(chance.randint(1, 40))]
            child.kill()
        said += child.stdout.readlines()
        assert child.stderr.read() == ""
        assert child.wait() == -9
    return [line.strip() for line in said if line.endswith("\n")]


def kill_over_and_over(knowledge: Path, kills: int, chance: random.Random) -> None:
    acknowledged: list[str] = []
    stood_before: list[str] = []
    for _ in range(kills):
        acknowledged += teach_and_kill(knowledge, chance)
        if not knowledge.exists():  # killed before the file was born
            assert acknowledged == []
            continue
        events = read_lessons(knowledge, ROBOT, eager_task())
        stands = [event.origin.command_id for event in events]
        times = Counter(stands)
        assert all(times[command_id] == 1 for command_id in acknowledged)
        assert set(times.values()) <= {1}
        assert stands[: len(stood_before)] == stood_before
        with Journal.read_only(knowledge) as journal:
            assert check_knowledge(journal) == []
        stood_before = stands
    assert acknowledged != []
    assert len(set(acknowledged)) == len(acknowledged)


@pytest.mark.deep
def test_no_acknowledged_lesson_is_lost_in_three_kills(tmp_path: Path) -> None:
    kill_over_and_over(tmp_path / "knowledge", 3, random.Random(2004))


@pytest.mark.deep
@pytest.mark.parametrize("file", range(10))
def test_no_acknowledged_lesson_is_lost_in_a_hundred_kills(tmp_path: Path, file: int) -> None:
    kill_over_and_over(tmp_path / "knowledge", 10, random.Random(file))
