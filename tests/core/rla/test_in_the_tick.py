"""Expectations and surprises in whole ticks."""

import numpy as np
import pytest

from kurt2rt.core.rla.rla import MID
from kurt2rt.core.rla.statistics import Expectation, Statistics, pack
from kurt2rt.core.teaching.commands import BeAt, NameSituation, Resume, Stop, Teach
from tests.core.rla.helpers import created
from tests.core.test_tick_learning import Drive
from tests.core.test_tick_with_mid_level import LENGTH, STREETS, Town, the_way

NEAR, FAR = 400, 50


@pytest.fixture
def drive() -> Drive:
    """Taught to go forward near things, and to bear left far from them; stands between two lessons."""
    drive = Drive()
    drive.run(Teach("near", "Ann", "forward"), counts=NEAR)
    drive.run(Stop("s-0", "Ann"))
    drive.run(Teach("far", "Ann", "bear_left"), counts=FAR)
    drive.run(Resume("r-0", "Ann"), counts=NEAR)
    return drive


def going_on_from(drive: Drive) -> Drive:
    """Another run of that robot's program."""
    return Drive(drive.notebook.events, checkpoint=drive.runtime.snapshot())


def comes_and_goes(drive: Drive, times: int = 1, far: int = FAR) -> None:
    """Near things for a while, then away from them for two ticks."""
    for _ in range(times):
        drive.run(counts=NEAR, ticks=30)
        drive.run(counts=far, ticks=12)


def test_expectations_survive_a_restart(drive: Drive) -> None:
    comes_and_goes(drive, times=8)
    saved = drive.runtime.snapshot()
    assert {rla_id: each.count for rla_id, each in saved.expectations.items()} == {1: 8, 2: 7}
    again = going_on_from(drive)
    again.run(counts=NEAR, ticks=30)
    record = again.run(counts=FAR + 60)
    assert record.surprise is not None
    assert record.surprise.surprising
    assert again.runtime.snapshot().expectations[1].count == 9


def test_expectations_of_idle_level_are_kept() -> None:
    place = created(3, (1.0,) * LENGTH, level=MID)
    foreign = Expectation("lesson-3", 4, 800.0, pack(np.ones(LENGTH)), pack(np.zeros(LENGTH)))
    drive = Drive([created(1, (0.0,) * 72), place], checkpoint=Statistics(expectations={3: foreign, 9: foreign}))
    assert drive.runtime.snapshot().expectations == {3: foreign}


@pytest.fixture
def town() -> Town:
    """Stands before its first junction and has been told to go straight on there; RLA 4 says so."""
    town = Town()
    town.way_to_the_first_junction()
    town.run(the_way("straight_on", "first"))
    return town


def test_mid_expectation_ignores_localisation() -> None:
    town = Town(task=STREETS.model_copy(update={"mid": "places"}))
    town.way_to_the_first_junction()
    town.run(NameSituation("n", "Ann", "door"))
    town.run(the_way("straight_on", "first"))
    town.junction()
    town.run(the_way("straight_on", "second"))  # RLA 5
    assert town.runtime.snapshot().expectations[4].count == 1
    town.street()
    (told,) = town.run(BeAt("b", "Ann", "door")).results
    assert told.accepted, told.outcome
    town.street()
    saved = town.runtime.snapshot()
    assert 5 not in saved.expectations
    assert saved.uses[4] == 1
