"""Simulated robot in real time: its thread, and a teacher who reaches into its world."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from hal.bus import BusError
from simbridge.contracts.simulation import SimulatedWorld
from simbridge.contracts.world_refusal import WorldRefusal, WorldRefusedError
from simbridge.realtime import RealtimeSimulation, RealtimeWorld
from simbridge.worlds.obstacle_settings import PolygonObstacleSettings, RoundObstacleSettings, WallSettings
from tests.patience import PATIENCE_S
from tests.simbridge.rig import ROBOT, Rig, room


class StepCounter:
    """Replacement of a robot's step that records the stepping threads and signals the n-th step.

    It reads the frames of each step: a main thread that waits for a processor would let them fill the bus.
    """

    def __init__(self, rig: Rig, monkeypatch: pytest.MonkeyPatch, wanted: int) -> None:
        self.threads: list[threading.Thread] = []
        self.enough = threading.Event()
        self._rig, self._step, self._wanted = rig, rig.robot.step, wanted
        monkeypatch.setattr(rig.robot, "step", self)

    def __call__(self) -> None:
        self._step()
        self._rig.listen()
        self.threads.append(threading.current_thread())
        if len(self.threads) >= self._wanted:
            self.enough.set()


def fail() -> None:
    raise ValueError("from a job")


def test_thread_steps_and_stops(monkeypatch: pytest.MonkeyPatch, rig: Rig) -> None:
    steps = StepCounter(rig, monkeypatch, 5)
    with RealtimeSimulation(rig.robot) as simulation:
        assert steps.enough.wait(PATIENCE_S)
    assert rig.robot.time_s == pytest.approx(len(steps.threads) * 0.01)
    assert simulation.error is None
    assert rig.heard["ENCODER"] == (0, 0)


def test_thread_error_is_raised_by_stop(rig: Rig) -> None:
    simulation = RealtimeSimulation(rig.robot)
    rig.robot_end.shutdown()
    simulation.start()
    simulation.wait(PATIENCE_S)
    assert isinstance(simulation.error, BusError)
    with pytest.raises(BusError):
        simulation.stop()


def test_stop_without_start_returns(rig: Rig) -> None:
    RealtimeSimulation(rig.robot).stop()


@pytest.mark.parametrize("body_error", [None, ValueError("from the body")])
def test_context_raises_the_bodys_error_first(body_error: ValueError | None, rig: Rig) -> None:
    def run() -> None:
        with RealtimeSimulation(rig.robot) as simulation:
            assert simulation.wait(PATIENCE_S)
            if body_error is not None:
                raise body_error

    rig.robot_end.shutdown()
    with pytest.raises(BusError if body_error is None else ValueError):
        run()


def test_submit_failing_job_ends_the_thread(rig: Rig) -> None:
    simulation = RealtimeSimulation(rig.robot)
    simulation.submit(fail)
    simulation.start()
    assert simulation.wait(PATIENCE_S)
    with pytest.raises(ValueError, match="from a job"):
        simulation.stop()
    assert rig.robot.time_s == 0.0


def test_hold_leaves_steps_and_jobs_to_the_caller(monkeypatch: pytest.MonkeyPatch, rig: Rig) -> None:
    steps = StepCounter(rig, monkeypatch, 4)
    jobs: list[int] = []
    with RealtimeSimulation(rig.robot, cycle_s=1e-3) as simulation:
        simulation.hold()
        steps.threads.clear()
        steps.enough.clear()
        simulation.submit(lambda: jobs.append(len(steps.threads)))
        for _ in range(3):
            simulation.step()
        assert steps.threads == [threading.current_thread()] * 3
        assert jobs == [0]
        simulation.go_on()
        assert steps.enough.wait(PATIENCE_S)
    assert threading.current_thread() not in steps.threads[3:]


BOARD = WallSettings(name="board", from_m=(0.5, 3.0), to_m=(1.5, 3.0), thickness_m=0.05)
POST = RoundObstacleSettings(name="post", x_m=1.0, y_m=1.0, radius_m=0.1)
BOX = PolygonObstacleSettings(name="box", corners=((3.0, 3.0), (3.4, 3.0), (3.4, 3.4)))
WORLD = room(walls=(BOARD,), posts=(POST,), boxes=(BOX,))
"""The robot stands in the middle, at (2, 2), and looks along x."""
LENGTH_M, WIDTH_M = ROBOT.geometry.outline_length_m, ROBOT.geometry.outline_width_m


class Yard:
    """A simulated robot that lives by itself, and the ground that it stands on."""

    def __init__(self, rig: Rig, simulation: RealtimeSimulation) -> None:
        self.rig = rig
        self.simulation = simulation
        self.ground: SimulatedWorld = RealtimeWorld(rig.robot, WORLD, ROBOT.geometry, simulation)

    def step(self) -> None:
        """Wait until the thread has run all submitted calls."""
        done = threading.Event()
        self.simulation.submit(done.set)
        assert done.wait(PATIENCE_S)


@contextmanager
def refused(code: WorldRefusal, **fields: object) -> Iterator[None]:
    """Expect a WorldRefusedError of this code and these fields."""
    with pytest.raises(WorldRefusedError) as caught:
        yield
    assert (caught.value.code, caught.value.fields) == (code, fields)


@pytest.fixture
def yard() -> Iterator[Yard]:
    with Rig(WORLD) as rig, RealtimeSimulation(rig.robot) as simulation:
        yield Yard(rig, simulation)


@pytest.mark.parametrize("name", ["board", "post", "box"])
def test_a_wall_is_moved_for_the_robot_too_and_the_version_grows(yard: Yard, name: str) -> None:
    yard.ground.move_wall(name, 0.25, -0.5)
    yard.step()
    assert yard.ground.world().version == yard.ground.place().world_version == 1
    moved = WORLD.moved(name, 0.25, -0.5)
    assert yard.rig.robot.world.settings == moved
    view = yard.ground.world()
    assert [wall.corners for wall in view.walls] == [
        *(each.corners for each in moved.walls),
        moved.polygon_obstacles[0].corners,
    ]
    assert view.posts[0].x_m == moved.round_obstacles[0].x_m


def test_move_wall_unknown_name_is_refused(yard: Yard) -> None:
    with refused(WorldRefusal.NO_WALL, world=WORLD.name, name="tree", known=("board", "post", "box")):
        yard.ground.move_wall("tree", 0.1, 0.0)
    assert yard.ground.world().version == 0


@pytest.mark.parametrize(
    ("name", "dx_m", "dy_m"),
    [("board", 1.0, -1.0), ("post", 1.0, 1.0), ("box", -1.2, -1.1)],
    ids=lambda value: str(value),
)
def test_nothing_is_put_where_the_robot_is(yard: Yard, name: str, dx_m: float, dy_m: float) -> None:
    with refused(WorldRefusal.WALL_ON_ROBOT, name=name):
        yard.ground.move_wall(name, dx_m, dy_m)
    yard.step()
    assert yard.ground.world().version == 0
    assert yard.rig.robot.world.settings == WORLD


@pytest.mark.parametrize(("x_m", "y_m"), [(1.0, 1.0), (0.1, 2.0), (50.0, 50.0)], ids=["post", "outer wall", "far away"])
def test_it_is_put_only_where_there_is_room(yard: Yard, x_m: float, y_m: float) -> None:
    with refused(WorldRefusal.NO_ROOM):
        yard.ground.put_robot(x_m, y_m, 0.0)
    yard.step()
    assert yard.ground.place().x_m == 2.0
