"""One question of a robot that stands at the border of R, where noise lets it drive for moments."""

import pytest

from kurt2rt.core.decision.decision import StandReason
from kurt2rt.core.decision.standing import Standing
from kurt2rt.core.progress_meter import ProgressMeter
from kurt2rt.core.teaching.commands import Resume, Stop
from kurt2rt.core.tick_record import TickRecord
from tests.core.test_tick import Corridor
from tests.teacher.helpers import teach

BORDER = 135
"""Counts around which noise of a few counts is inside and outside R of the lesson at 100."""
INSIDE = 134
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


@pytest.fixture
def border() -> Border:
    return Border()


def test_stop_and_go_leave_the_question_open(border: Border) -> None:
    stopped = border.run(BORDER, 600, Stop("s", "Ann"))
    assert stopped.standing.reason is StandReason.STOPPED
    assert border.run(BORDER + 20, 2, Resume("r", "Ann")).standing == ASKS
    assert len(border.asked) == 1


def test_question_at_a_bumper_replaces_the_one_before(border: Border) -> None:
    border.corridor.robot.touches_in_front = True
    border.run(INSIDE, 98)
    assert border.run(BORDER + 20).standing == ASKS  # noise: still the first question
    assert len(border.asked) == 1
    record = border.run(INSIDE, 100)
    assert record.standing == Standing(StandReason.FRONT_BUMPER, asks=True)
    assert len(border.asked) == 2
