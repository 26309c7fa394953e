"""Many simulations opened at once are those that are opened one by one."""

from contextlib import closing

import pytest

from config.settings import SettingsError
from simbridge.contracts.batch import Start
from simbridge.robot_simulation import Kurt2Simulation
from tests.simbridge.batch.both_ways import FACTORY


def test_simulations_opened_at_once_equal_single_ones() -> None:
    starts = [Start("a", 1), Start("rooms-7", 2), Start("a", 3)]
    for start, opened in zip(starts, FACTORY.open_all(starts, "exam"), strict=True):
        assert isinstance(opened, Kurt2Simulation)
        with closing(opened), closing(FACTORY.open(*start, "exam")) as single:
            assert opened.simulated_robot.state_hash() == single.simulated_robot.state_hash()


def test_unknown_world_is_refused_among_known_ones() -> None:
    with pytest.raises(SettingsError, match="nowhere"):
        FACTORY.open_all([Start("a", 1), Start("nowhere", 2)], "exam")
