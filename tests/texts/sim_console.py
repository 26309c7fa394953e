"""Listings of the console of `kurt2rt sim`: its answers, the news of the robot, and its status line."""

from collections.abc import Iterator
from contextlib import closing

from hal.control import Mode, SpeedControl, SystemControl
from simbridge.sim_console import StatusLine
from tests.cli.test_sim_desk import SLOWLY, Table

_LINES = (
    *("start 3", "start 13", "place 1 1 90", "place 0 0 0", "place 1 1"),
    *("move tongue 0 -0.1", "move ceiling 0 1", "move tongue 1", "lift", "lower"),
)


def answers() -> Iterator[tuple[str, str]]:
    """Yield the answer to each kind of line."""
    with closing(Table()) as table:
        for line in _LINES:
            yield line, table.desk.obey(line)


def news() -> Iterator[tuple[str, str]]:
    """Yield the news of a robot that is driven, left alone, crashed and revived, and its status line meanwhile."""
    with closing(Table()) as table:
        line = StatusLine(table.standalone)
        table.desk.obey("place 0.5 0.27 -90")
        yield "at first", line.next()
        for name, cycles, told in (
            ("driven", 100, SLOWLY),
            ("left alone", 30, None),
            ("a jump", 1, SpeedControl(Mode.SPEED_CM, 90, 90)),
            ("a reset", 1, SystemControl(Mode.MC_RESET)),
        ):
            yield name, "; ".join([*table.cycles(cycles, told), line.next()])
        table.desk.obey("lift")
        yield "lifted", line.next()
