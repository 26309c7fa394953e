"""Console of the simulated robot: its commands, news and status line."""

import io
import itertools
import math
from collections.abc import Iterator

import pytest

from hal.bus import CanBus, open_bus
from hal.control import Mode, SpeedControl, SystemControl, control_frame
from simbridge.sim_console import HELP, News, SimConsole, StatusLine, TypedLines
from simbridge.simulated_world import Kurt2World
from simbridge.standalone import StandaloneRobot
from simbridge.worlds.world_loading import load_world
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
        self.standalone = StandaloneRobot(ROBOT, WORLD, self.end, seed=1, start=1)
        self.robot = self.standalone.robot
        self.asked: list[object] = []
        simulation = self.standalone.simulation
        simulation.submit = lambda job: self.asked.append(job())  # type: ignore[method-assign]  # no thread runs here
        self.desk = SimConsole(self.standalone, WORLD, Kurt2World(self.robot, WORLD, ROBOT.geometry, simulation))
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


@pytest.fixture
def table() -> Iterator[Table]:
    table = Table()
    yield table
    table.end.shutdown()
    table.notebook.shutdown()


def test_the_robot_is_put_at_a_start_pose(table: Table) -> None:
    assert table.desk.obey("start 3\n") == "the robot stands at 2.30 2.75 m, 0 deg"
    assert table.robot.pose == WORLD.start_poses[2].pose
    for wrong in ("start", "start 0", "start 13", "start x", "start 1 2"):
        assert table.desk.obey(wrong) == "this world has the start poses 1 to 12"


def test_the_robot_is_put_where_there_is_room(table: Table) -> None:
    assert table.desk.obey("place 1.0 1.0 90") == "the robot stands at 1.00 1.00 m, 90 deg"
    assert table.robot.pose == pytest.approx((1.0, 1.0, math.pi / 2))
    assert table.desk.obey("place 0 0 0") == "there is no room for the robot there"
    for wrong in ("place", "place 1 1", "place 1 1 nan", "place 1 1 north"):
        assert table.desk.obey(wrong) == "say where: place X Y HEADING, in metres and degrees"
    assert table.robot.pose == pytest.approx((1.0, 1.0, math.pi / 2))


def test_a_wall_is_moved(table: Table) -> None:
    before = WORLD.walls[0].from_m
    assert table.desk.obey("move tongue 0 -0.1") == "tongue moved"
    assert table.robot.world.settings.walls[0].from_m == pytest.approx((before[0], before[1] - 0.1))
    assert table.desk.obey("move ceiling 0 1") == "world A: nothing is named 'ceiling'; there are: tongue"
    assert table.desk.obey("move tongue 1") == "say by how much: move NAME DX DY, in metres"


def test_a_lifted_robot_turns_its_wheels_in_the_air(table: Table) -> None:
    pose = table.robot.pose
    assert "on a block" in table.desk.obey("lift")
    table.cycles(50, SLOWLY)
    assert table.robot.wheel_speeds.left_m_s > 0.05
    assert table.robot.pose == pose
    assert StatusLine(table.standalone).next().endswith("| on a block")
    assert "on its wheels" in table.desk.obey("lower")
    table.cycles(50, SLOWLY)
    assert table.robot.pose != pose


@pytest.mark.parametrize(("line", "said"), [("help", HELP), ("", ""), ("dance", f"not understood: dance\n{HELP}")])
def test_sim_console_with_help_or_nonsense_lists_the_commands(table: Table, line: str, said: str) -> None:
    assert table.desk.obey(line) == said


def test_news_are_told_once(table: Table) -> None:
    assert table.cycles(30) == []
    assert table.cycles(30, SLOWLY) == ["CONTROL is heard and obeyed"]
    assert table.cycles(30) == ["CONTROL has ceased: the watchdog brakes"]
    crash = SpeedControl(Mode.SPEED_CM, 90, 90)
    assert table.cycles(1, crash) == [
        "CONTROL is heard and obeyed",
        "a set point jumped: the controller crashed, MC_RESET revives it",
    ]
    assert StatusLine(table.standalone).next().endswith("| crashed, needs MC_RESET")
    assert table.cycles(1, SystemControl(Mode.MC_RESET)) == ["the controller is alive"]
    table.end.shutdown()
    assert table.cycles(3)[0].startswith("lost: bus virtual:desk-test-")


def test_a_collision_is_told_with_its_place(table: Table) -> None:
    table.desk.obey("place 0.5 0.27 -90")
    assert [line for line in table.cycles(100, SLOWLY) if "collision" in line] == [
        "collision 1 at 0.50 0.22 m, -90 deg"
    ]


def test_the_status_line_tells_where_it_is_and_what_it_was_told(table: Table) -> None:
    line = StatusLine(table.standalone)
    assert line.next() == (
        "     0.0 s | at 0.54 3.63 m, 0 deg | wheels +0.00 +0.00 m/s, ordered +0.00 +0.00 with brakes | "
        "CONTROL 0 a second, junk 0 | collisions 0 | missed 0 | no CONTROL, braked"
    )
    table.cycles(200, SLOWLY)
    now = line.next()
    assert now.startswith("     2.0 s | at 0.73 3.63 m, ")
    assert now.endswith(
        "| wheels +0.10 +0.10 m/s, ordered +0.10 +0.10 | CONTROL 100 a second, junk 0 | collisions 0 | missed 0"
    )
    assert "CONTROL 0 a second" in line.next()


def test_lines_are_there_when_they_are_looked_for() -> None:
    keyboard = TypedLines(io.StringIO("lift\nlower\n"))
    keyboard.thread.join(30.0)
    assert keyboard.ended
    assert list(keyboard.typed()) == ["lift\n", "lower\n"]
    assert list(keyboard.typed()) == []
