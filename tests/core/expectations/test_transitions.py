"""Ends of RLAs, by themselves or by commands."""

import numpy as np

from kurt2rt.core.decision.decision import MidDecision
from kurt2rt.core.expectations.transitions import BasicTransitionTracker, MidTransitionTracker
from tests.core.expectations.helpers import Small
from tests.core.rla.helpers import created, replaced


class Drive:
    """The basic level, tick by tick."""

    def __init__(self) -> None:
        self.small = Small()
        self.following = BasicTransitionTracker(self.small.expectations)
        self.tick = 0

    def see(self, rla_id: int | None, place: float = 0.0, *, ticks: int = 1, behaviour: str = "") -> None:
        for _ in range(ticks):
            self.following.update(self.tick, rla_id, np.array([place, 0.0]), behaviour)
            self.tick += 1


class Journey:
    """The mid level, junction by junction."""

    def __init__(self) -> None:
        self.small = Small("hamming")
        self.following = MidTransitionTracker(self.small.expectations)
        self.situation = np.zeros(3)

    def comes_to(self, *symbols: float) -> None:
        self.situation = np.array(symbols)

    def sees(self, rla_id: int | None, ticks: int = 1, *, driving: bool = True) -> None:
        decision = MidDecision("straight_on", rla_id, None, rla_id is None, False, None)
        for _ in range(ticks):
            self.following.update(decision, self.situation, driving=driving)


def test_basic_rla_ends_when_another_takes_over() -> None:
    drive = Drive()
    drive.see(1, 10.0, ticks=30)
    drive.see(2, 20.0)
    expected = drive.small.expected(1)
    assert (expected.mean.tolist(), expected.ticks, expected.count) == ([20.0, 0.0], 30.0, 1)


def test_basic_standstill_is_no_follow_up() -> None:
    drive = Drive()
    drive.see(1, 10.0, ticks=3)
    drive.see(None, 20.0, ticks=3)
    drive.see(2, 30.0)
    assert drive.small.expectations.get(1) is None


def test_basic_change_of_behaviour_is_no_follow_up() -> None:
    drive = Drive()
    drive.see(1, 10.0, ticks=3, behaviour="straight_on")
    drive.see(2, 20.0, ticks=3, behaviour="turn_left")
    drive.see(3, 30.0, behaviour="turn_left")
    assert drive.small.expectations.get(1) is None
    assert drive.small.expected(2).mean.tolist() == [30.0, 0.0]


def test_basic_correction_of_the_driver_restarts() -> None:
    drive = Drive()
    drive.see(1, ticks=50)
    event = replaced(1, "backward", "forward")
    drive.small.system.apply(event)
    assert drive.following.on_event(event) == 1
    drive.see(1, ticks=5)
    drive.see(2, 20.0)
    assert drive.small.expected(1).ticks == 5.0


def test_mid_rla_ends_at_a_junction() -> None:
    journey = Journey()
    journey.comes_to(1.0, 0.0, 0.0)
    journey.sees(1, ticks=800)
    journey.comes_to(2.0, 1.0, 0.0)
    journey.sees(2)
    expected = journey.small.expected(1)
    assert (expected.mean.tolist(), expected.ticks) == ([2.0, 1.0, 0.0], 800.0)


def test_mid_waiting_does_not_count() -> None:
    journey = Journey()
    journey.comes_to(1.0, 0.0, 0.0)
    journey.sees(1, ticks=10)
    journey.sees(1, ticks=500, driving=False)
    journey.comes_to(2.0, 1.0, 0.0)
    journey.sees(2)
    assert journey.small.expected(1).ticks == 10.0


def test_mid_change_between_junctions_is_no_end() -> None:
    journey = Journey()
    journey.comes_to(1.0, 0.0, 0.0)
    journey.sees(1, ticks=10)
    journey.sees(2, ticks=10)
    journey.comes_to(2.0, 1.0, 0.0)
    journey.sees(3)
    assert journey.small.expectations.get(1) is None
    assert journey.small.expected(2).ticks == 10.0


def test_mid_follow_up_may_be_taught_later() -> None:
    journey = Journey()
    journey.comes_to(1.0, 0.0, 0.0)
    journey.sees(1, ticks=10)
    journey.comes_to(2.0, 1.0, 0.0)
    journey.sees(None, ticks=300, driving=False)
    journey.small.system.apply(created(4, (2.0, 1.0, 0.0), level="mid"))
    journey.sees(4, ticks=10)
    expected = journey.small.expected(1)
    assert (expected.mean.tolist(), expected.ticks, expected.count) == ([2.0, 1.0, 0.0], 10.0, 1)


def test_mid_repositioned_robot_has_no_predecessor() -> None:
    journey = Journey()
    journey.comes_to(1.0, 0.0, 0.0)
    journey.sees(1, ticks=10)
    journey.following.restart()
    journey.comes_to(0.0, 0.0, 0.0)
    journey.sees(2)
    assert journey.small.expectations.get(1) is None
