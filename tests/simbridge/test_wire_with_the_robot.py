"""The robot over a wire: a good one changes nothing, and a bad one makes it stand where it must."""

import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest
import yaml

from config import CONFIG_DIR
from hal.bus_state import ControllerState
from hal.guard_reason import GuardReason
from hal.robot import STANDSTILL, GuardResult, WheelSpeeds
from kurt2rt.experiments.exam import examine
from kurt2rt.simulated import Kurt2Simulation
from kurt2rt.tasks.settings import load_task
from tests.simbridge.rig import ROBOT

TURN = WheelSpeeds(0.2, -0.2)
TICK_S = ROBOT.can.cycle_s


def wire_with(folder: Path, **changes: dict[str, object]) -> str:
    """A file like the shipped one_megabit, with some keys of its parts changed."""
    content = yaml.safe_load((CONFIG_DIR / "wires" / "one_megabit.yaml").read_text(encoding="utf-8"))
    for part, values in changes.items():
        content[part].update(values)
    path = folder / "mine.yaml"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    return str(path)


class Drive:
    """Somebody who turns the robot on the spot, tick by tick."""

    def __init__(self, simulation: Kurt2Simulation) -> None:
        self.simulation = simulation
        self.ticks = 0
        self.senses = simulation.robot.sense(0.0)
        self.grant = GuardResult(STANDSTILL, (), latched=False)

    @property
    def now_s(self) -> float:
        return self.ticks * TICK_S

    def controller(self) -> ControllerState:
        """How the notebook's controller says it is."""
        return self.simulation.robot.health.controller

    def until(self, time_s: float) -> list[GuardResult]:
        """What was granted in each tick up to this time."""
        grants = []
        while self.now_s < time_s - TICK_S / 2:
            self.ticks += 1
            self.simulation.step()
            self.senses = self.simulation.robot.sense(self.now_s)
            self.grant = self.simulation.robot.drive(TURN, self.now_s, self.now_s)
            grants.append(self.grant)
        return grants


@contextmanager
def driving(wire: str, seed: int = 1) -> Iterator[Drive]:
    with closing(Kurt2Simulation(ROBOT, "a", seed, "wire", wire)) as simulation:
        yield Drive(simulation)


async def policy_drives(wire: str, seed: int, seconds: float = 1.5, world: str = "a") -> str:
    """Let the teacher's policy drive, which must not stop for the bus; the state that it ends in."""
    task = load_task("wall_following")
    task = task.model_copy(update={"exam": task.exam.model_copy(update={"duration_s": seconds})})
    with closing(Kurt2Simulation(ROBOT, world, seed, "exam", wire)) as simulation:
        result = await examine(
            simulation, ROBOT, task, world, [], seed=seed, on_progress=lambda _: None, by_teacher=True
        )
        assert simulation.robot.health.latched is None
        assert (result.collisions, result.stuck) == (0, False)
        return simulation.simulated_robot.state_hash()


async def test_a_good_wire_changes_nothing_to_the_last_bit() -> None:
    """All telemetry of a cycle is there before the tick, and CONTROL before the next cycle, as with no wire at all."""
    without = await policy_drives("none", 1)
    assert await policy_drives("ideal", 1) == without
    assert await policy_drives("one_megabit", 1) == without


async def test_the_same_seed_gives_the_same_run_over_a_bad_wire() -> None:
    first = await policy_drives("lossy", 3)
    assert await policy_drives("lossy", 3) == first
    assert await policy_drives("none", 3) != first


def test_the_senses_are_as_old_as_the_wire_and_the_ticks_phase_make_them() -> None:
    """The tick comes 5 ms after the cycle. Ahead of ENCODER go three frames of distances, each of about 0.12 ms."""
    with driving("one_megabit") as drive:
        for tick in range(1, 50):
            drive.until(tick * TICK_S)
            assert 0.0041 < drive.senses.bumper_age_s < drive.senses.encoder_age_s < 0.0046
            assert 0.0047 < drive.senses.infrared_age_s < 0.0049


def test_a_tick_at_the_very_beginning_of_the_cycle_hears_of_the_cycle_before(tmp_path: Path) -> None:
    path = Path(wire_with(tmp_path))
    path.write_text(path.read_text(encoding="utf-8").replace("notebook_phase_s: 0.005", "notebook_phase_s: 0.0"))
    with driving(str(path)) as drive:
        drive.until(0.5)
        assert drive.senses.encoder_age_s == pytest.approx(0.0094, abs=0.0001)
        assert not drive.grant.reasons
        assert drive.grant.wheel_speeds == TURN


def test_a_robot_that_misses_every_tenth_frame_turns_on() -> None:
    with driving("lossy") as drive:
        grants = drive.until(7.0)
    moving = sum(grant.wheel_speeds == TURN for grant in grants)
    assert moving > 0.95 * len(grants)
    assert not any(grant.latched for grant in grants)


def test_without_encoders_it_stands(tmp_path: Path) -> None:
    with driving(wire_with(tmp_path, loss={"shares_by_id": [[0x09, 1.0]]})) as drive:
        drive.until(0.5)
        assert drive.grant.reasons == (GuardReason.ENCODER_STALE,)
        assert drive.simulation.simulated_robot.wheel_speeds == (0.0, 0.0)


def test_noise_that_takes_the_controllers_off_the_bus_stops_it_until_it_is_released(tmp_path: Path) -> None:
    """Ten milliseconds of noise: both controllers go bus-off with their next frame, and start anew after 100 ms."""
    with driving(wire_with(tmp_path, noise={"bursts_s": [[1.0, 1.01]]})) as drive:
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


def test_a_robot_that_goes_off_the_bus_alone_leaves_control_unanswered_and_the_guard_sees_it(tmp_path: Path) -> None:
    """A millisecond of noise while the robot sends, over before the notebook does."""
    with driving(wire_with(tmp_path, noise={"bursts_s": [[1.0, 1.001]]})) as drive:
        drive.until(1.04)
        assert drive.grant.reasons == (GuardReason.BUS_BLOCKED,)
        assert drive.controller() is ControllerState.PASSIVE
        drive.until(2.0)  # the robot is back, and hears what waited: two old set points, then brakes
        assert drive.controller() is ControllerState.ACTIVE
        assert drive.simulation.simulated_robot.wheel_speeds == (0.0, 0.0)
        drive.simulation.robot.release()
        drive.until(3.0)
        assert drive.grant.wheel_speeds == TURN


def test_in_real_time_the_wire_goes_by_the_clock() -> None:
    with closing(Kurt2Simulation(ROBOT, "a", 1, "wire", "one_megabit")) as simulation, simulation.live() as realtime:
        for _ in range(3):  # the frames of one cycle are out when the next one begins
            stepped = threading.Event()
            realtime.submit(stepped.set)
            assert stepped.wait(5.0)
        senses = simulation.robot.sense(0.0)
        assert 0.0 <= senses.encoder_age_s < 5.0
        assert len(set(senses.infrared_counts)) > 1


@pytest.mark.deep
@pytest.mark.parametrize("world", ["a", "b", "c"])
async def test_the_policy_follows_walls_over_a_wire_that_loses_every_tenth_frame(world: str) -> None:
    for seed in range(5):
        await policy_drives("lossy", seed, 60.0, world)


@pytest.mark.deep
async def test_a_good_wire_changes_nothing_in_a_minute_in_any_world() -> None:
    for world in ("a", "b", "c"):
        assert await policy_drives("one_megabit", 0, 60.0, world) == await policy_drives("none", 0, 60.0, world)
