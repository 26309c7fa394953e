"""RobotRepositioner with ticks of 0.1 s."""

import random

from kurt2rt.teacher.scripted.supervisor import RobotRepositioner
from simbridge.contracts.simulation import SimulatedPlace
from tests.channel.states import state

AFTER_S = 15.0
PERIOD_S = 0.1


def place(x_m: float, collisions: int = 0) -> SimulatedPlace:
    return SimulatedPlace(x_m, 2.0, 0.5, 0.0, collisions, 0)


class Watched:
    """Robot on a line with its repositioner."""

    def __init__(self, lesson_speed: float = 1.0) -> None:
        self.lesson_speed = lesson_speed
        self.repositioner = RobotRepositioner(AFTER_S, 1.0, PERIOD_S, random.Random(3))
        self.tick = 0

    def is_at(self, x_m: float, *, collisions: int = 0, waits: bool = False) -> SimulatedPlace | None:
        """Move the robot there within 0.5 s."""
        self.tick += 5
        seen = state(tick=self.tick, place=place(x_m, collisions), phase=2, lesson_speed=self.lesson_speed)
        return self.repositioner.update(seen, waits=waits)

    def stays(self, x_m: float, seconds: float, *, waits: bool = False) -> list[SimulatedPlace]:
        """Keep the robot about a place; return the places to put it."""
        found = (self.is_at(x_m + 0.3 * (step % 2), waits=waits) for step in range(round(seconds / 0.5)))
        return [each for each in found if each is not None]


def test_update_with_progress_or_waiting_returns_none() -> None:
    robot = Watched()
    assert [robot.is_at(0.05 * step) for step in range(200)] == [None] * 200
    assert robot.stays(9.9, 60.0, waits=True) == []
    assert robot.stays(9.9, 14.0) == []


def test_update_place_of_a_collision_is_not_chosen() -> None:
    robot = Watched()
    robot.is_at(0.0)
    robot.is_at(1.1, collisions=1)
    robot.is_at(2.2, collisions=2)
    for _ in range(5):
        found = [robot.is_at(2.2, collisions=2) for _ in range(32)]
        assert [each.x_m for each in found if each is not None] == [0.0]


def test_update_place_where_it_was_stuck_is_not_chosen_later() -> None:
    robot = Watched()
    robot.is_at(0.0)
    robot.is_at(2.2, collisions=1)
    for _ in range(2):  # the first command was lost
        assert [each.x_m for each in (robot.is_at(2.2, collisions=1) for _ in range(32)) if each] == [0.0]
    robot.is_at(0.0, collisions=1)
    for _ in range(8):
        found = [robot.is_at(8.0, collisions=2) for _ in range(33)]
        assert [each.x_m for each in found if each is not None] == [0.0]


def test_update_without_a_place_returns_none() -> None:
    repositioner = RobotRepositioner(AFTER_S, 1.0, PERIOD_S, random.Random(3))
    assert not any(repositioner.update(state(tick=tick, place=None), waits=False) for tick in range(0, 1000, 5))
