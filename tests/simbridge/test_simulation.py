"""Openers of simulations: many of KURT2 at once, and of a robot over a RobotLink, which is simulated as KURT2 is."""

import pickle
import random
import time
from collections.abc import Sequence
from contextlib import closing

import pytest

from config.settings import SettingsError
from hal.linked_robot import LinkedRobot
from hal.robot_settings import RobotSettings
from hal.tap import Tap
from simbridge.contracts.batch import BatchFactory, Start
from simbridge.contracts.batch_lesson import LessonFactory
from simbridge.contracts.simulation import Pose, SimulationFactory
from simbridge.robot.noise import Noise
from simbridge.robot.world import World
from simbridge.robot_simulation import Kurt2Simulation
from simbridge.simulation import Kurt2SimulationFactory, LinkSimulationFactory
from tests.patience import PATIENCE_S
from tests.simbridge.batch.both_ways import FACTORY
from tests.simbridge.direct_link import DirectLink
from tests.simbridge.rig import ROBOT


def test_simulations_opened_at_once_equal_single_ones() -> None:
    starts = [Start("a", 1), Start("rooms-7", 2), Start("a", 3)]
    for start, opened in zip(starts, FACTORY.open_all(starts, "exam"), strict=True):
        assert isinstance(opened, Kurt2Simulation)
        with closing(opened), closing(FACTORY.open(*start, "exam")) as single:
            assert opened.simulated_robot.state_hash() == single.simulated_robot.state_hash()


def test_unknown_world_is_refused_among_known_ones() -> None:
    with pytest.raises(SettingsError, match="nowhere"):
        FACTORY.open_all([Start("a", 1), Start("nowhere", 2)], "exam")


LINKED = LinkSimulationFactory(ROBOT, open_link=DirectLink)


class CompassSensors:
    """Range sensors that read the robot's position along x, in cm."""

    def __init__(self, sensors: int) -> None:
        self.counts = [0] * sensors
        self.due_s: tuple[float, ...] = ()

    def measure(self, pose: Pose) -> Sequence[int]:
        self.measure_all(pose)
        return range(len(self.counts))

    def measure_all(self, pose: Pose) -> None:
        self.counts[:] = [round(100 * pose.x_m)] * len(self.counts)


def compass_sensors(robot: RobotSettings, world: World, noise: Noise, build: Noise) -> CompassSensors:  # noqa: ARG001
    return CompassSensors(len(robot.infrared.sensors))


def test_link_simulation_has_sensors_of_the_plug_in() -> None:
    factory = LinkSimulationFactory(ROBOT, open_link=DirectLink, make_sensors=compass_sensors)
    with closing(factory.open("a", 1, "exam")) as simulation:
        simulation.put(Pose(1.5, 0.5, 0.0))
        simulation.step()
        assert set(simulation.robot.sense(0.01).infrared_counts) == {150}


def test_link_factory_pickles_and_has_no_batch() -> None:
    again: SimulationFactory = pickle.loads(pickle.dumps(LINKED))
    assert again.settings_of("a") == LINKED.settings_of("a")
    assert not isinstance(LINKED, BatchFactory | LessonFactory)
    assert isinstance(Kurt2SimulationFactory(ROBOT), BatchFactory)


def test_link_factory_tap_is_refused() -> None:
    class Silent:
        def on_rx(self, *_: object) -> None: ...

        def on_tx(self, *_: object) -> None: ...

    tap: Tap = Silent()
    with pytest.raises(SettingsError, match="no CAN frames"):
        LINKED.live("a", 1, tap)


def test_link_simulation_lives_in_real_time() -> None:
    with LINKED.live("a", 1) as live:
        assert isinstance(live.robot, LinkedRobot)
        assert live.robot.watchdog.running
        deadline_s = time.monotonic() + PATIENCE_S
        while live.robot.sense(time.monotonic()).infrared_age_s > 1.0 and time.monotonic() < deadline_s:
            time.sleep(0.01)
        assert live.world.lives
        live.simulation.reposition(random.Random(1), in_sight=True)
    assert live.robot.health.latched is not None
