"""Control authority: teacher, presence and the deadline of a drive by hand, at the borders of each number."""

import pytest

from kurt2rt.core.outcome import Outcome, RefusalCode
from kurt2rt.core.teaching.authority import ControlAuthority
from kurt2rt.core.teaching.commands import Drive
from tests.core.helpers import Counted

LEASE, REACH = 24, 35
NOW = 1000


class Hands:
    """An authority over a robot with one action, that Ann teaches."""

    def __init__(self, *, attended: bool = True) -> None:
        self.action = Counted()
        self.authority = ControlAuthority({"a": self.action}, attended=attended)
        self.authority.claim("Ann")

    def drive(self, tick: int = NOW, *, seen: int | None = None, hold: int = 1) -> None:
        self.authority.drive(press(hold, seen=tick if seen is None else seen), tick)

    def driven_ticks(self, first: int = NOW, last: int = NOW + 100) -> list[int]:
        """Return the ticks in which the teacher drives, each expired as the loop does."""
        driven = []
        for tick in range(first, last):
            self.authority.expire(tick)
            if self.authority.is_manual(tick):
                driven.append(tick)
        return driven


def press(hold: int = 1, *, teacher: str = "Ann", seen: int = NOW) -> Drive:
    return Drive(teacher, seen, hold, 0.2, 0.1)


@pytest.fixture
def hands() -> Hands:
    return Hands()


@pytest.mark.parametrize(
    ("age", "driven"),
    [(0, LEASE), (11, LEASE), (12, LEASE - 1), (34, 1), (35, 0), (40, 0)],
    ids=lambda value: str(value),
)
def test_late_message_drives_until_35_ticks_after_its_state(age: int, driven: int) -> None:
    hands = Hands()
    hands.drive(NOW, seen=NOW - age)
    assert hands.driven_ticks() == list(range(NOW, NOW + driven))


def test_unchanging_state_ends_the_drive(hands: Hands) -> None:
    for tick in range(NOW, NOW + REACH):
        hands.drive(tick, seen=NOW)
        assert hands.authority.is_manual(tick)
    hands.drive(NOW + REACH, seen=NOW)
    assert not hands.authority.is_manual(NOW + REACH)


def test_presence_lasts_its_lease_within_35_ticks_of_the_state(hands: Hands) -> None:
    present = hands.authority.is_present
    assert not present(NOW)
    hands.authority.renew_presence("Ann", NOW, NOW)
    assert [present(NOW + LEASE - 1), present(NOW + LEASE)] == [True, False]
    hands.authority.renew_presence("Ann", NOW + 50, NOW + 30)
    assert [present(NOW + 30 + REACH - 1), present(NOW + 30 + REACH)] == [True, False]


@pytest.mark.parametrize("behaviour", [False, True])
def test_nobody_takes_the_robot_from_a_hand_on_the_wheels(behaviour: bool) -> None:
    hands = Hands(attended=False)
    if behaviour:
        hands.authority.run("a", NOW, LEASE)
    else:
        hands.drive(NOW)
    refusal = Outcome.of(RefusalCode.DRIVES_BY_HAND, teacher="Ann")
    assert hands.authority.take_over("Ben", NOW + LEASE - 1) == refusal
    assert hands.authority.teacher == "Ann"
    assert hands.authority.take_over("Ben", NOW + LEASE) is None


@pytest.mark.parametrize("to", ["Ben", None])
def test_handing_over_ends_hand_and_presence(hands: Hands, to: str | None) -> None:
    hands.drive(NOW, hold=3)
    hands.authority.hand_over(to)
    assert hands.authority.teacher == to
    assert not hands.authority.is_manual(NOW)
    assert not hands.authority.is_present(NOW)
    assert hands.authority.is_press_over(press(3))


def test_a_behaviour_ends_for_good_when_its_teacher_is_gone(hands: Hands) -> None:
    hands.authority.renew_presence("Ann", NOW, NOW)
    hands.authority.run("a", NOW, 1000)
    assert hands.driven_ticks(NOW, NOW + 60) == list(range(NOW, NOW + LEASE))
    hands.authority.renew_presence("Ann", NOW + 60, NOW + 60)
    assert not hands.authority.is_manual(NOW + 60)
