"""Console of the simulated robot: its commands, news and status line."""

import io
import itertools
import math
from collections.abc import Iterator

import pytest

from hal.bus import CanBus, open_bus
from hal.control import Mode, SpeedControl, SystemControl, control_frame
from simbridge.contracts.world_refusal import WorldRefusal, WorldRefusedError
from simbridge.links import CanRobotEnd
from simbridge.realtime import RealtimeWorld, StandaloneRobot
from simbridge.sim_console import HELP, News, SimConsole, StatusLine, TypedLines
from simbridge.worlds.world_loading import load_world
from tests.patience import PATIENCE_S
from tests.simbridge.rig import ROBOT

WORLD = load_world("a")
SLOWLY = SpeedControl(Mode.SPEED_CM, 10, 10)
_numbers = itertools.count()


class Table:
    """A robot that goes on when the test says so, and a notebook that tells it what to do."""

    def __init__(self) -> None:
        name = f"virtual:desk-test-{next(_numbers)}"
        self.end: CanBus = open_bus(name)
        self.notebook = open_bus(name)
        self.control = self.notebook.control_port()
        self.standalone = StandaloneRobot(WORLD, CanRobotEnd(ROBOT, self.end), seed=1, start=1)
        self.robot = self.standalone.robot
        self.asked: list[object] = []
        simulation = self.standalone.simulation
        simulation.submit = lambda job: self.asked.append(job())  # type: ignore[method-assign]  # no thread runs here
        self.desk = SimConsole(self.standalone, WORLD, RealtimeWorld(self.robot, WORLD, ROBOT.geometry, simulation))
        self.news = News(self.standalone)

    def cycles(self, count: int, told: SpeedControl | SystemControl | None = None) -> list[str]:
        """Let the robot go on; what was news meanwhile."""
        heard: list[str] = []
        for _ in range(count):
            if told is not None:
                self.control.send(control_frame(told))
            self.robot.step()
            heard += self.news.since()
        return heard

    def close(self) -> None:
        self.end.shutdown()
        self.notebook.shutdown()


@pytest.fixture
def table() -> Iterator[Table]:
    table = Table()
    yield table
    table.close()


def test_the_robot_is_put_at_a_start_pose(table: Table) -> None:
    assert " 2.30 2.75 m, " in table.desk.obey("start 3\n")
    assert table.robot.pose == WORLD.start_poses[2].pose
    for wrong in ("start", "start 0", "start 13", "start x", "start 1 2"):
        assert table.desk.obey(wrong).endswith(" 1 to 12")
    assert table.robot.pose == WORLD.start_poses[2].pose


def test_the_robot_is_put_where_there_is_room(table: Table) -> None:
    assert table.desk.obey("place 1.0 1.0 90").endswith(" 1.00 1.00 m, 90 deg")
    assert table.robot.pose == pytest.approx((1.0, 1.0, math.pi / 2))
    assert table.desk.obey("place 0 0 0") == str(WorldRefusedError(WorldRefusal.NO_ROOM))
    for wrong in ("place", "place 1 1", "place 1 1 nan", "place 1 1 north"):
        assert "X Y HEADING" in table.desk.obey(wrong)
    assert table.robot.pose == pytest.approx((1.0, 1.0, math.pi / 2))


@pytest.mark.parametrize(("line", "said"), [("help", HELP), ("", ""), ("dance", f"not understood: dance\n{HELP}")])
def test_sim_console_with_help_or_nonsense_lists_the_commands(table: Table, line: str, said: str) -> None:
    assert table.desk.obey(line) == said


def test_news_are_told_once(table: Table) -> None:
    assert table.cycles(30) == []
    (heard,) = table.cycles(30, SLOWLY)
    (ceased,) = table.cycles(30)
    assert "watchdog" in ceased
    heard_again, crashed = table.cycles(1, SpeedControl(Mode.SPEED_CM, 90, 90))
    assert heard_again == heard
    assert "MC_RESET" in crashed
    assert StatusLine(table.standalone).next().endswith(" MC_RESET")
    assert len(table.cycles(1, SystemControl(Mode.MC_RESET))) == 1
    table.end.shutdown()
    assert table.end.name in table.cycles(3)[0]


def test_lines_are_there_when_they_are_looked_for() -> None:
    keyboard = TypedLines(io.StringIO("lift\nlower\n"))
    keyboard.thread.join(PATIENCE_S)
    assert keyboard.ended
    assert list(keyboard.typed()) == ["lift\n", "lower\n"]
    assert list(keyboard.typed()) == []
