"""The robot program is killed at any moment, over and over on the same file, and no acknowledged lesson is lost."""

import random
import subprocess
from pathlib import Path

import pytest

from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.journal.journal import Journal
from tests.cli.helpers import ROOT, started
from tests.knowledge.lessons import BINDING, created


def teach_and_kill(path: Path, chance: random.Random) -> list[str]:
    """Let a child teach, kill it, and return what it said was acknowledged."""
    most = str(chance.randint(1, 6))
    with started("tests.knowledge.teach_until_killed", str(path), most, folder=ROOT) as child:
        assert child.stdout is not None
        assert child.stderr is not None
        said: list[str] = []
        if chance.random() < 0.3:  # at any moment of its life, also while the file is being opened or born
            try:
                child.wait(timeout=chance.uniform(0.0, 0.25))
            except subprocess.TimeoutExpired:
                child.kill()
        else:
            said += [child.stdout.readline() for _ in range(chance.randint(1, 25))]
            child.kill()
        said += child.stdout.readlines()
        assert child.stderr.read() == ""
        assert child.wait() == -9
    return [line.strip() for line in said if line.endswith("\n")]


def kill_over_and_over(path: Path, kills: int, seed: int) -> None:
    chance = random.Random(seed)
    acknowledged: list[str] = []
    taught_before = 0
    for _ in range(kills):
        acknowledged += teach_and_kill(path, chance)
        if not path.exists():  # killed before the file was born
            assert acknowledged == []
            continue
        with Journal.open(path, BINDING) as journal:
            assert journal.check() == []
            events = journal.events()
            statistics = journal.statistics()
        assert events == [created(number) for number in range(1, len(events) + 1)]
        rows = {f"{event.origin.command_id} {row}" for row, event in enumerate(events, start=1)}
        assert rows.issuperset(acknowledged)
        assert len(set(acknowledged)) == len(acknowledged)
        assert len(events) >= taught_before
        assert statistics == Statistics() or statistics.uses[1] == statistics.transitions[1, 2]
        taught_before = len(events)
    assert acknowledged != []


def test_kill_three_times_keeps_acknowledged_lessons(path: Path) -> None:
    kill_over_and_over(path, kills=3, seed=2004)


@pytest.mark.deep
def test_kill_a_hundred_times_keeps_acknowledged_lessons(path: Path) -> None:
    kill_over_and_over(path, kills=100, seed=1)
