"""Robot over a wire: a good wire changes nothing, a bad one makes the robot stand if necessary."""

import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest

from hal.bus_state import ControllerState
from hal.guard_reason import GuardReason
from hal.robot import STANDSTILL, GuardResult, WheelSpeeds
from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.lockstep.exam import ExamSetup, examine
from simbridge.kurt2_simulation import Kurt2Simulation
from tests.patience import PATIENCE_S
from tests.simbridge.rig import ROBOT
from tests.simbridge.wires import changed

TURN = WheelSpeeds(0.2, -0.2)
TICK_S = ROBOT.cycle_s


class Drive:
    """Driver that turns the robot on the spot, tick by tick."""

    def __init__(self, simulation: Kurt2Simulation) -> None:
        self.simulation = simulation
        self.ticks = 0
        self.readings = simulation.robot.sense(0.0)
        self.grant = GuardResult(STANDSTILL, (), latched=False)

    @property
    def now_s(self) -> float:
        return self.ticks * TICK_S

    def controller(self) -> ControllerState:
        """Return the reported state of the notebook's controller."""
        return self.simulation.robot.health.controller

    def until(self, time_s: float) -> list[GuardResult]:
        """Return the guard's results of each tick up to this time."""
        grants = []
        while self.now_s < time_s - TICK_S / 2:
            self.ticks += 1
            self.simulation.step()
            self.readings = self.simulation.robot.sense(self.now_s)
            self.grant = self.simulation.robot.drive(TURN, self.now_s, self.now_s)
            grants.append(self.grant)
        return grants


@contextmanager
def driving(wire: str, seed: int = 1) -> Iterator[Drive]:
    with closing(Kurt2Simulation(ROBOT, "a", seed, "wire", wire)) as simulation:
        yield Drive(simulation)


async def policy_drives(wire: str, seed: int, seconds: float = 1.5, world: str = "a") -> str:
    """Let the teacher's policy drive without a stop by the bus, and return the hash of the last state."""
    task = load_task("wall_following")
    task = task.model_copy(update={"exam": task.exam.model_copy(update={"duration_s": seconds})})
    with closing(Kurt2Simulation(ROBOT, world, seed, "exam", wire)) as simulation:
        result = await examine(simulation, ROBOT, task, [], ExamSetup(world, seed, teacher_policy=True), lambda _: None)
        assert simulation.robot.health.latched is None
        assert (result.collisions, result.stuck) == (0, False)
        return simulation.simulated_robot.state_hash()


async def test_good_wire_equals_no_wire_to_the_last_bit() -> None:
    """All telemetry of a cycle arrives before the tick, and CONTROL before the next cycle, as without a wire."""
    without = await policy_drives("none", 1)
    assert await policy_drives("ideal", 1) == without
    assert await policy_drives("one_megabit", 1) == without


async def test_lossy_wire_same_seed_gives_the_same_run() -> None:
    first = await policy_drives("lossy", 3)
    assert await policy_drives("lossy", 3) == first
    assert await policy_drives("none", 3) != first


def test_age_of_readings_is_transmission_time_plus_phase() -> None:
    """The tick comes 5 ms after the cycle. Ahead of ENCODER go three frames of distances, each of about 0.12 ms."""
    with driving("one_megabit") as drive:
        for tick in range(1, 50):
            drive.until(tick * TICK_S)
            assert 0.0041 < drive.readings.bumper_age_s < drive.readings.encoder_age_s < 0.0046
            assert 0.0047 < drive.readings.infrared_age_s < 0.0049


def test_tick_at_phase_zero_gets_the_previous_cycle(tmp_path: Path) -> None:
    path = Path(changed(tmp_path))
    path.write_text(path.read_text(encoding="utf-8").replace("notebook_phase_s: 0.005", "notebook_phase_s: 0.0"))
    with driving(str(path)) as drive:
        drive.until(0.5)
        assert drive.readings.encoder_age_s == pytest.approx(0.0094, abs=0.0001)
        assert not drive.grant.reasons
        assert drive.grant.wheel_speeds == TURN


def test_robot_over_a_lossy_wire_keeps_turning() -> None:
    with driving("lossy") as drive:
        grants = drive.until(7.0)
    moving = sum(grant.wheel_speeds == TURN for grant in grants)
    assert moving > 0.95 * len(grants)
    assert not any(grant.latched for grant in grants)


def test_robot_without_encoder_frames_stands(tmp_path: Path) -> None:
    with driving(changed(tmp_path, loss={"shares_by_id": [[0x09, 1.0]]})) as drive:
        drive.until(0.5)
        assert drive.grant.reasons == (GuardReason.ENCODER_STALE,)
        assert drive.simulation.simulated_robot.wheel_speeds == (0.0, 0.0)


def test_robot_after_bus_off_stands_until_released(tmp_path: Path) -> None:
    """Ten milliseconds of noise: both controllers go bus-off with their next frame, and restart after 100 ms."""
    with driving(changed(tmp_path, noise={"bursts_s": [[1.0, 1.01]]})) as drive:
        drive.until(1.0)
        assert drive.grant.wheel_speeds == TURN
        drive.until(1.02)
        assert drive.grant.latched
        assert drive.grant.reasons == (GuardReason.BUS_OFF,)
        assert drive.controller() is ControllerState.OFF
        drive.until(1.1)  # nothing reaches the robot: its own watchdog has to brake
        assert drive.simulation.simulated_robot.wheel_speeds != (0.0, 0.0)
        drive.until(2.0)
        assert drive.simulation.simulated_robot.wheel_speeds == (0.0, 0.0)
        assert drive.controller() is ControllerState.ACTIVE
        assert drive.grant.reasons == (GuardReason.BUS_OFF,)
        drive.simulation.robot.release()
        drive.until(3.0)
        assert drive.grant.wheel_speeds == TURN
        assert not drive.grant.reasons


def test_guard_sees_a_robot_that_alone_is_bus_off(tmp_path: Path) -> None:
    """A millisecond of noise while the robot sends, over before the notebook does."""
    with driving(changed(tmp_path, noise={"bursts_s": [[1.0, 1.001]]})) as drive:
        drive.until(1.04)
        assert drive.grant.reasons == (GuardReason.BUS_BLOCKED,)
        assert drive.controller() is ControllerState.PASSIVE
        drive.until(2.0)  # the robot is back, and hears what waited: two old set points, then brakes
        assert drive.controller() is ControllerState.ACTIVE
        assert drive.simulation.simulated_robot.wheel_speeds == (0.0, 0.0)
        drive.simulation.robot.release()
        drive.until(3.0)
        assert drive.grant.wheel_speeds == TURN


def test_wire_in_real_time_follows_the_clock() -> None:
    with closing(Kurt2Simulation(ROBOT, "a", 1, "wire", "one_megabit")) as simulation, simulation.live() as realtime:
        for _ in range(3):  # the frames of one cycle are out when the next one begins
            stepped = threading.Event()
            realtime.submit(stepped.set)
            assert stepped.wait(PATIENCE_S)
        readings = simulation.robot.sense(0.0)
        assert 0.0 <= readings.encoder_age_s < 5.0
        assert len(set(readings.infrared_counts)) > 1


@pytest.mark.deep
@pytest.mark.parametrize("world", ["a", "b", "c"])
async def test_policy_over_a_lossy_wire_follows_walls(world: str) -> None:
    for seed in range(5):
        await policy_drives("lossy", seed, 60.0, world)


@pytest.mark.deep
async def test_good_wire_equals_no_wire_for_a_minute() -> None:
    for world in ("a", "b", "c"):
        assert await policy_drives("one_megabit", 0, 60.0, world) == await policy_drives("none", 0, 60.0, world)
