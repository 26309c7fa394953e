"""When an RLA has ended of itself, and when something else has ended it."""

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


def test_an_rla_ends_in_the_situation_in_which_another_takes_over() -> None:
    drive = Drive()
    drive.see(1, 10.0, ticks=30)
    drive.see(2, 20.0)
    expected = drive.small.expected(1)
    assert (expected.mean.tolist(), expected.ticks, expected.count) == ([20.0, 0.0], 30.0, 1)


def test_standing_is_no_follow_up() -> None:
    drive = Drive()
    drive.see(1, 10.0, ticks=3)
    drive.see(None, 20.0, ticks=3)
    drive.see(2, 30.0)
    assert drive.small.expectations.get(1) is None


def test_what_a_command_ended_did_not_lead_there() -> None:
    drive = Drive()
    drive.see(1, 10.0, ticks=3, behaviour="straight_on")
    drive.see(2, 20.0, ticks=3, behaviour="turn_left")
    drive.see(3, 30.0, behaviour="turn_left")
    assert drive.small.expectations.get(1) is None
    assert drive.small.expected(2).mean.tolist() == [30.0, 0.0]


def test_a_correction_of_the_one_that_drives_begins_anew() -> None:
    drive = Drive()
    drive.see(1, ticks=50)
    event = replaced(1, "backward", "forward")
    drive.small.system.apply(event)
    assert drive.following.on_event(event) == 1
    drive.see(1, ticks=5)
    drive.see(2, 20.0)
    assert drive.small.expected(1).ticks == 5.0


def test_at_the_mid_level_an_rla_ends_where_a_junction_was_passed() -> None:
    journey = Journey()
    journey.comes_to(1.0, 0.0, 0.0)
    journey.sees(1, ticks=800)
    journey.comes_to(2.0, 1.0, 0.0)
    journey.sees(2)
    expected = journey.small.expected(1)
    assert (expected.mean.tolist(), expected.ticks) == ([2.0, 1.0, 0.0], 800.0)


def test_it_may_follow_itself() -> None:
    journey = Journey()
    journey.comes_to(1.0, 0.0, 0.0)
    journey.sees(1, ticks=10)
    journey.comes_to(1.0, 1.0, 0.0)
    journey.sees(1)
    assert journey.small.expected(1).mean.tolist() == [1.0, 1.0, 0.0]


def test_waiting_is_not_the_way() -> None:
    journey = Journey()
    journey.comes_to(1.0, 0.0, 0.0)
    journey.sees(1, ticks=10)
    journey.sees(1, ticks=500, driving=False)
    journey.comes_to(2.0, 1.0, 0.0)
    journey.sees(2)
    assert journey.small.expected(1).ticks == 10.0


def test_what_changes_while_no_junction_was_passed_follows_from_nothing() -> None:
    journey = Journey()
    journey.comes_to(1.0, 0.0, 0.0)
    journey.sees(1, ticks=10)
    journey.sees(2, ticks=10)
    journey.comes_to(2.0, 1.0, 0.0)
    journey.sees(3)
    assert journey.small.expectations.get(1) is None
    assert journey.small.expected(2).ticks == 10.0


def test_what_is_taught_where_nobody_knew_the_way_on_is_what_followed() -> None:
    journey = Journey()
    journey.comes_to(1.0, 0.0, 0.0)
    journey.sees(1, ticks=10)
    journey.comes_to(2.0, 1.0, 0.0)
    journey.sees(None, ticks=300, driving=False)
    journey.small.system.apply(created(4, (2.0, 1.0, 0.0), level="mid"))
    journey.sees(4, ticks=10)
    expected = journey.small.expected(1)
    assert (expected.mean.tolist(), expected.ticks, expected.count) == ([2.0, 1.0, 0.0], 10.0, 1)


def test_who_was_set_down_elsewhere_came_from_nowhere() -> None:
    journey = Journey()
    journey.comes_to(1.0, 0.0, 0.0)
    journey.sees(1, ticks=10)
    journey.following.restart()
    journey.comes_to(0.0, 0.0, 0.0)
    journey.sees(2)
    assert journey.small.expectations.get(1) is None
