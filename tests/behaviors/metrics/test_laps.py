import math
import random

import pytest

from behaviors.metrics.laps import LapsSettings
from behaviors.metrics.task_metric import TaskMetric
from behaviors.metrics.way import WaySettings
from hal.robot import WheelSpeeds
from kurt2rt.core.task_settings import load_task
from simbridge.contracts.simulation import Pose
from simbridge.robot_simulation import Kurt2Simulation
from tests.experiments.helpers import STAGE, short_task, teachers_drive

WANTED_M = 0.365


def laps_in(simulation: Kurt2Simulation) -> TaskMetric:
    settings = LapsSettings(kind="laps", wanted_m=WANTED_M)
    return settings.build(simulation, ("",), random.Random(1))


@pytest.mark.parametrize(("towards_rad", "sign"), [(math.pi / 2, 1), (-math.pi / 2, -1)])
def test_laps_count_forwards_and_subtract_backwards(towards_rad: float, sign: int) -> None:
    simulation = STAGE.open("one_object", 1, "test")
    try:
        metric = laps_in(simulation)
        simulation.simulated_robot.place(Pose(0.4, 2.2, towards_rad))
        before = metric.progress
        for tick in range(300):
            simulation.robot.sense(tick * 0.01)
            simulation.robot.drive(WheelSpeeds(0.3, 0.3), tick * 0.01, tick * 0.01)
            simulation.step()
            metric.update(simulation.pose)
        way_m = abs(simulation.pose.y_m - 2.2)
        assert way_m > 0.5
        # Once round, 0.35 m from the walls of 4.4 m, is 14.8 m.
        assert sign * (metric.progress - before) == pytest.approx(way_m / 14.8, rel=0.05)
    finally:
        simulation.close()


def test_least_progress_is_a_tenth_of_a_metre_a_second() -> None:
    simulation = STAGE.open("one_object", 1, "test")
    try:
        assert simulation.lap_m == pytest.approx(4 * (4.4 - 2 * 0.35))
        laps = LapsSettings(kind="laps", wanted_m=WANTED_M).least_progress(simulation, 300.0)
        assert laps * simulation.lap_m == pytest.approx(30.0)
        assert WaySettings(kind="way").least_progress(simulation, 300.0) == pytest.approx(30.0)
        assert load_task("circle").metric.least_progress(simulation, 300.0) == 0.0
    finally:
        simulation.close()


def test_laps_of_the_policy_in_narrow_places_are_its_way() -> None:
    world = "maps/flat"  # through a door of 0.6 m
    drive = teachers_drive(short_task(exam_s=8.0, worlds=(world,)))
    simulation = STAGE.open(world, 1, "test")
    try:
        assert drive.progress * simulation.lap_m == pytest.approx(drive.way_m, rel=0.15)
    finally:
        simulation.close()
