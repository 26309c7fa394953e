"""A robot that makes no way is set down where it came through; its ticks are a tenth of a second."""

import random

from hal.simulation import SimulatedPlace
from kurt2rt.teacher.scripted.repositioner import RobotRepositioner
from tests.channel.states import state

AFTER_S = 15.0
PERIOD_S = 0.1


def place(x_m: float, collisions: int = 0) -> SimulatedPlace:
    return SimulatedPlace(x_m, 2.0, 0.5, 0.0, collisions, 0)


class Watched:
    """A robot on a line, and the hand that watches it."""

    def __init__(self) -> None:
        self.hand = RobotRepositioner(AFTER_S, 1.0, PERIOD_S, random.Random(3))
        self.tick = 0

    def is_at(self, x_m: float, *, collisions: int = 0, waits: bool = False) -> SimulatedPlace | None:
        """Half a second later it is there."""
        self.tick += 5
        return self.hand.see(state(tick=self.tick, place=place(x_m, collisions)), waits=waits)

    def stays(self, x_m: float, seconds: float, *, waits: bool = False) -> list[SimulatedPlace]:
        """It is about there for so long; where it was to be set down meanwhile."""
        found = (self.is_at(x_m + 0.3 * (step % 2), waits=waits) for step in range(round(seconds / 0.5)))
        return [each for each in found if each is not None]


def test_it_is_set_down_where_it_came_through_and_not_where_it_is() -> None:
    robot = Watched()
    for metres in range(6):
        assert robot.is_at(1.2 * metres) is None
    (to,) = robot.stays(6.1, 16.0)
    assert to.x_m in (0.0, 1.2, 2.4, 3.6, 4.8)
    assert to.heading_rad == 0.5
    assert robot.stays(to.x_m, 14.0) == []  # it has as long there


def test_one_that_makes_way_or_waits_for_its_teacher_is_left_alone() -> None:
    robot = Watched()
    assert [robot.is_at(0.05 * step) for step in range(200)] == [None] * 200
    assert robot.stays(9.9, 60.0, waits=True) == []
    assert robot.stays(9.9, 14.0) == []


def test_where_it_touched_something_it_is_not_set_down() -> None:
    robot = Watched()
    robot.is_at(0.0)
    robot.is_at(1.1, collisions=1)
    robot.is_at(2.2, collisions=2)
    for _ in range(5):
        found = [robot.is_at(2.2, collisions=2) for _ in range(32)]
        assert [each.x_m for each in found if each is not None] == [0.0]


def test_where_it_was_stuck_it_is_not_set_down_later_either() -> None:
    robot = Watched()
    robot.is_at(0.0)
    robot.is_at(2.2, collisions=1)
    for _ in range(2):  # the first time the hand was not heard
        assert [each.x_m for each in (robot.is_at(2.2, collisions=1) for _ in range(32)) if each] == [0.0]
    robot.is_at(0.0, collisions=1)
    for _ in range(8):
        found = [robot.is_at(8.0, collisions=2) for _ in range(33)]
        assert [each.x_m for each in found if each is not None] == [0.0]


def test_one_that_never_came_away_is_set_down_where_it_began() -> None:
    assert [each.x_m for each in Watched().stays(0.4, 16.0)] == [0.4]


def test_a_robot_whose_place_nobody_knows_is_not_moved() -> None:
    hand = RobotRepositioner(AFTER_S, 1.0, PERIOD_S, random.Random(3))
    assert not any(hand.see(state(tick=tick, place=None), waits=False) for tick in range(0, 1000, 5))
