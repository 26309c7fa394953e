"""One question of a robot that stands at the border of R, where noise lets it drive for moments."""

import random
from collections.abc import Callable

import pytest

from hal.open_question import OPEN_TICKS, SURE_SHARE
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.decision.standing import Standing, StandReason
from kurt2rt.core.progress_meter import ProgressMeter
from kurt2rt.core.teaching.commands import Resume, Stop
from kurt2rt.core.teaching.inbox import RobotRepositioned
from kurt2rt.core.tick_record import TickRecord
from tests.core.test_tick import RADIUS, Corridor
from tests.core.test_tick_by_hand import press
from tests.teacher.helpers import pursue, teach

BORDER = 135
"""Counts around which noise of a few counts is inside and outside R of the lesson at 100."""
INSIDE, SURE = 134, 105
ASKS = Standing(StandReason.ASKS, asks=True)


class Border:
    """Robot that learned forward at 100 counts and then stands at the border of R, asking its question."""

    def __init__(self, **options: bool) -> None:
        self.corridor = Corridor(behaviours=("", "other"), **options)
        self.meter = ProgressMeter(0.01)
        self.asked: list[int] = []
        self.run(100, 1, teach("forward", "first"))
        self.asked.clear()
        self.run(100)
        self.question = self.run(BORDER + 20)

    def run(self, counts: int, ticks: int = 1, *commands: object) -> TickRecord:
        for _ in range(ticks):
            record = self.corridor.run(counts, *commands)  # type: ignore[arg-type]
            commands = ()
            self.meter.update(record)
            self.asked += [record.tick] * record.question_begins
        return record

    def asks_anew(self) -> bool:
        before = len(self.asked)
        return self.run(BORDER + 20).standing == ASKS and len(self.asked) > before


@pytest.fixture
def border() -> Border:
    return Border()


def test_noise_at_the_border_of_r_is_one_question(border: Border) -> None:
    noise, shown, causes = random.Random(1), set(), set()
    for _ in range(2000):
        record = border.run(BORDER + round(noise.gauss(0.0, 2.0)))
        shown.add(record.standing)
        causes.add(record.decision.cause)
    assert {DecisionCause.RLA, DecisionCause.UNKNOWN} <= causes  # the noise lets it drive, again and again
    assert shown == {ASKS}
    assert (len(border.asked), border.meter.progress().asks) == (1, 1)


def test_question_ends_after_half_a_second_with_a_margin(border: Border) -> None:
    border.run(SURE, OPEN_TICKS // 2 - 1)
    assert not border.asks_anew()
    border.run(SURE, OPEN_TICKS // 2)
    assert border.asks_anew()


def test_question_ends_after_a_second_of_driving(border: Border) -> None:
    match = border.run(INSIDE).decision.match
    assert match is not None
    assert SURE_SHARE * RADIUS < match.distance <= RADIUS
    border.run(INSIDE, OPEN_TICKS - 2)
    assert not border.asks_anew()
    border.run(INSIDE, OPEN_TICKS)
    assert border.asks_anew()


def test_question_of_a_robot_that_stands_stays_open(border: Border) -> None:
    border.corridor.robot.touches_in_front = True
    border.run(INSIDE, 40)  # not for as long as to ask about the bumper
    border.run(BORDER + 20)
    border.run(INSIDE, 40)
    assert border.run(BORDER + 20).standing == ASKS
    assert len(border.asked) == 1


def test_stop_and_go_leave_the_question_open(border: Border) -> None:
    stopped = border.run(BORDER, 600, Stop("s", "Ann"))
    assert stopped.standing.reason is StandReason.STOPPED
    assert border.run(BORDER + 20, 2, Resume("r", "Ann")).standing == ASKS
    assert len(border.asked) == 1


@pytest.mark.parametrize(
    "end",
    [
        lambda border: border.run(BORDER + 20, 1, teach("back", "second")),
        lambda border: (border.run(BORDER + 20, 60, press(border.corridor)), border.run(BORDER, 1, Resume("r", "Ann"))),
        lambda border: border.run(BORDER + 20, 1, RobotRepositioned()),
        lambda border: border.run(BORDER + 20, 1, pursue("other"), pursue("")),
    ],
    ids=["answered", "pressed", "put elsewhere", "another behaviour"],
)
def test_question_is_over_at_once(border: Border, end: Callable[[Border], object]) -> None:
    end(border)
    border.run(200)
    assert len(border.asked) == 2


def test_question_at_a_bumper_replaces_the_one_before(border: Border) -> None:
    border.corridor.robot.touches_in_front = True
    border.run(INSIDE, 98)
    assert border.run(BORDER + 20).standing == ASKS  # noise: still the first question
    assert len(border.asked) == 1
    record = border.run(INSIDE, 100)
    assert record.standing == Standing(StandReason.FRONT_BUMPER, asks=True)
    assert len(border.asked) == 2
