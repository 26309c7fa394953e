"""Detection of single broken infra-red sensors from readings that the test makes."""

import random
from collections.abc import Callable

import pytest

from hal.kurt2_settings import Kurt2Settings, load_kurt2
from hal.robot import SensorReadings
from hal.sensor_signs import LOOK_TICKS, RANGE_TICKS, STUCK_TIMES, SensorFault
from hal.sensor_watch import BrokenSensor, SensorWatch

ROBOT = load_kurt2()
INFRARED = ROBOT.infrared
STUCK_TICKS = round(STUCK_TIMES * ROBOT.guard.frozen_infrared_s / ROBOT.cycle_s)
FORWARD_TICKS = round(0.3 * ROBOT.cycle_s / ROBOT.geometry.metres_per_tick)
"""Encoder ticks of a tick at 0.3 m/s."""
PLACES = {name: place for place, name in enumerate(INFRARED.names)}

Fault = Callable[[int], int]
"""Function from the tick to the reading of a faulty sensor, in counts."""


class Drive:
    """Readings of 18 noisy sensors, of which some see a wall that comes and goes, and a watch."""

    def __init__(self, robot: Kurt2Settings = ROBOT) -> None:
        self.watch = SensorWatch(robot)
        self.left_ticks = self.right_ticks = 0
        """Encoder ticks in each tick of driving; 0, as on a circle round what a sensor sees."""
        self.bumpers = 0
        self.faults: dict[str, Fault] = {}
        self.near: tuple[str, ...] = ()
        """Sensors that see a wall for 2 s in every 4 s."""
        self.noisy = True
        self._chance = random.Random(4)
        self._ticks = 0
        self._counts = [0] * len(INFRARED.names)

    def run(self, ticks: int, *, driving: bool = True) -> tuple[BrokenSensor, ...]:
        """Return the sensors that are noticed within so many ticks."""
        found: tuple[BrokenSensor, ...] = ()
        for _ in range(ticks):
            self._ticks += 1
            if self._ticks % 4 == 1:
                self._measure()
            left, right = (self.left_ticks, self.right_ticks) if driving else (0, 0)
            readings = SensorReadings(0.0, tuple(self._counts), 0.0, left, right, 0.0, self.bumpers, 0.0)
            found += self.watch.update(readings, driving=driving)
        return found

    def _measure(self) -> None:
        sees = self._ticks % 400 >= 200
        for name, place in PLACES.items():
            mean = 300 if sees and name in self.near else 70
            if name in self.faults:
                self._counts[place] = self.faults[name](self._ticks)
            else:
                self._counts[place] = round(self._chance.gauss(mean, max(1.5, 0.02 * mean))) if self.noisy else mean


@pytest.fixture
def drive() -> Drive:
    return Drive()


def test_watch_of_healthy_sensors_finds_nothing(drive: Drive) -> None:
    drive.near = ("s1", "s3", "s4", "s2", "s15")
    assert drive.run(12_000) == ()


@pytest.mark.parametrize("name", INFRARED.names)
@pytest.mark.parametrize("counts", [70, 294, 550])
def test_watch_finds_a_stuck_sensor_in_four_seconds(drive: Drive, name: str, counts: int) -> None:
    drive.run(200)
    drive.faults[name] = lambda _: counts
    assert drive.run(STUCK_TICKS // 2) == ()
    (found,) = drive.run(STUCK_TICKS // 2 + 3 * LOOK_TICKS)
    assert (found.name, found.fault, found.counts) == (name, SensorFault.STUCK, counts)
    assert found == drive.watch.broken[0]
    assert drive.watch.places == (PLACES[name],)


def test_watch_finds_a_stuck_sensor_whose_last_bit_flickers(drive: Drive) -> None:
    drive.faults["s9"] = lambda tick: 212 + tick // 4 % 3
    assert [each.title for each in drive.run(STUCK_TICKS + 3 * LOOK_TICKS)] == ["front left (s9)"]


def test_watch_waits_longer_for_robots_with_quiet_sensors() -> None:
    guard = ROBOT.guard.model_copy(update={"frozen_infrared_s": 2.0})
    drive = Drive(ROBOT.model_copy(update={"guard": guard}))
    drive.faults["s9"] = lambda _: 212
    assert drive.run(2 * STUCK_TICKS - LOOK_TICKS) == ()
    assert len(drive.run(3 * LOOK_TICKS)) == 1


def test_watch_does_not_count_time_in_which_the_robot_stands(drive: Drive) -> None:
    drive.faults["s9"] = lambda _: 212
    assert drive.run(10 * STUCK_TICKS, driving=False) == ()
    assert drive.run(STUCK_TICKS - LOOK_TICKS) == ()
    assert len(drive.run(3 * LOOK_TICKS)) == 1


@pytest.mark.parametrize("counts", [0, 40, 700, 1023])
def test_watch_finds_readings_out_of_range_at_standstill(drive: Drive, counts: int) -> None:
    drive.faults["s3"] = lambda _: counts
    (found,) = drive.run(RANGE_TICKS + 3 * LOOK_TICKS, driving=False)
    assert (found.name, found.fault) == ("s3", SensorFault.OUT_OF_RANGE)


def test_watch_ignores_a_short_reading_out_of_range(drive: Drive) -> None:
    drive.faults["s3"] = lambda tick: 0 if tick % 60 < 40 else 75
    assert drive.run(2000, driving=False) == ()


@pytest.mark.parametrize(
    ("mean", "spread", "ticks", "fault"),
    [(70, 1.5, 1000, SensorFault.SEES_NOTHING), (550, 8, 3000, SensorFault.SEES_A_PHANTOM)],
)
def test_watch_finds_a_sensor_unlike_its_neighbours(
    drive: Drive, mean: float, spread: float, ticks: int, fault: SensorFault
) -> None:
    drive.near = ("s1", "s3", "s4", "s2")
    flicker = random.Random(1)
    drive.faults["s3"] = lambda _: round(flicker.gauss(mean, spread))
    (found,) = drive.run(ticks)
    assert (found.name, found.fault) == ("s3", fault)


def test_watch_takes_a_thin_post_for_no_phantom(drive: Drive) -> None:
    flicker = random.Random(1)
    drive.faults["s3"] = lambda _: round(flicker.gauss(300, 6))  # no neighbour ever sees anything
    assert drive.run(6000) == ()


def test_watch_finds_a_phantom_that_moves_with_the_robot(drive: Drive) -> None:
    flicker = random.Random(1)
    drive.left_ticks = drive.right_ticks = FORWARD_TICKS
    drive.faults["s3"] = lambda _: round(flicker.gauss(550, 11))  # no neighbour ever sees anything
    assert [(each.name, each.fault) for each in drive.run(400)] == [("s3", SensorFault.SEES_A_PHANTOM)]


def test_watch_sees_no_phantom_in_forged_encoder_frames(drive: Drive) -> None:
    flicker = random.Random(1)
    drive.left_ticks = drive.right_ticks = 30_000
    drive.faults["s3"] = lambda _: round(flicker.gauss(550, 11))
    assert drive.run(400) == ()


def test_watch_finds_no_phantom_in_a_circled_post(drive: Drive) -> None:
    """A post 0.196 m from s3 stays in its beam while the robot circles it to the left."""
    flicker = random.Random(1)
    middle_m = INFRARED.sensors[PLACES["s3"]].y_m + INFRARED.distance_m(300)
    outer = 1 + ROBOT.geometry.effective_track_m / 2 / middle_m
    drive.left_ticks, drive.right_ticks = round(FORWARD_TICKS * (2 - outer)), round(FORWARD_TICKS * outer)
    drive.faults["s3"] = lambda _: round(flicker.gauss(300, 6))
    assert drive.run(6000) == ()


def test_watch_takes_a_pressed_sensor_for_no_dark_one(drive: Drive) -> None:
    """A sensor that touches a wall reads less than its neighbours, because the law folds back."""
    flicker = random.Random(1)
    for name in ("s1", "s4", "s2", "s15"):
        drive.faults[name] = lambda tick: round(flicker.gauss(300 if tick % 400 < 200 else 420, 6))
    drive.faults["s3"] = lambda _: round(flicker.gauss(INFRARED.counts_at(0.0), 3))
    assert drive.run(3000) == ()


def test_watch_counts_no_time_while_a_bumper_is_pressed(drive: Drive) -> None:
    drive.faults["s9"] = lambda _: 212
    drive.bumpers = 1
    assert drive.run(3 * STUCK_TICKS) == ()


def test_watch_blames_no_neighbour_of_a_stuck_sensor(drive: Drive) -> None:
    drive.near = ("s4",)
    drive.run(300)
    drive.faults["s1"] = lambda _: 550
    drive.faults["s4"] = lambda tick: 300 + tick // 4 % 40
    assert {each.name for each in drive.run(4000)} == {"s1"}


def test_watch_leaves_a_board_without_change_to_others(drive: Drive) -> None:
    drive.noisy = False
    assert drive.run(3 * STUCK_TICKS) == ()
    for name in INFRARED.names[:12]:
        drive.faults[name] = lambda _: 0
    assert drive.run(3 * STUCK_TICKS) == ()


def test_readmit_trusts_a_sensor_that_changes_again(drive: Drive) -> None:
    drive.faults["s9"] = lambda _: 70
    drive.run(STUCK_TICKS + 3 * LOOK_TICKS)
    drive.watch.readmit()
    assert drive.watch.places == (PLACES["s9"],)
    drive.near = ("s9",)
    drive.faults.clear()
    drive.run(500)
    assert drive.watch.places == (PLACES["s9"],)
    drive.watch.readmit()
    assert not drive.watch.broken
    assert drive.run(2 * STUCK_TICKS) == ()


def test_readmitted_sensor_that_is_stuck_is_found_again(drive: Drive) -> None:
    drive.faults["s9"] = lambda tick: 70 if tick < 600 else 300
    drive.run(700)
    drive.watch.readmit()
    assert drive.watch.places == ()
    assert [each.name for each in drive.run(STUCK_TICKS + 3 * LOOK_TICKS)] == ["s9"]
