"""The KURT2 on its bus: what it senses, what it ignores, and how it stops."""

import math
from collections.abc import Iterator
from pathlib import Path

import can
import pytest
from hypothesis import given
from hypothesis import strategies as st

from config import CONFIG_DIR
from hal.bus import BusError, CanBus
from hal.codec import CodecError
from hal.control import Mode, RawControl, RawSide, SpeedControl
from hal.guard_reason import GuardReason
from hal.in_process_bus import InProcessBus
from hal.kurt2 import Kurt2
from hal.robot import STANDSTILL, GuardResult, WheelSpeeds
from tests.hal.helpers import (
    CODEC,
    INFRARED_FRAMES,
    ROBOT,
    SENSORS,
    TICK_S,
    bus_pair,
    controls,
    cycle,
    pull_the_plug,
    send,
    ticks,
)

BRAKE = RawControl(RawSide(0, brake=True), RawSide(0, brake=True))
Ends = tuple[CanBus, CanBus]


@pytest.fixture
def robot(ends: Ends) -> Iterator[Kurt2]:
    kurt2 = Kurt2(ROBOT, ends[0])
    yield kurt2
    kurt2.close()


def test_before_the_first_frame_it_is_blind_and_stands(robot: Kurt2, ends: Ends) -> None:
    assert robot.drive(WheelSpeeds(0.3, 0.3), 0.0, 0.0).wheel_speeds == STANDSTILL
    readings = robot.sense(1.0)
    assert readings.infrared_counts == (0,) * 18
    assert readings.infrared_age_s == readings.encoder_age_s == readings.bumper_age_s == math.inf
    assert robot.drive(WheelSpeeds(0.3, 0.3), 1.0, 1.0).reasons == (GuardReason.INFRARED_STALE,)
    assert controls(ends[1])[-1] == SpeedControl(Mode.SPEED_CM, 0, 0)


def test_each_sensor_reads_its_own_channel(robot: Kurt2, ends: Ends) -> None:
    counts_of = {sensor.channel: 100 + number for number, sensor in enumerate(SENSORS)}
    for name in INFRARED_FRAMES:
        message = CODEC.message(name)
        send(ends[1], [message.pack(*(counts_of.get(channel, 0xFFFF) for channel in message.signals))])
    assert robot.sense(1.0).infrared_counts == tuple(range(100, 118))
    assert robot.health.junk == 0


def test_the_newest_value_counts_and_ticks_add_up(robot: Kurt2, ends: Ends) -> None:
    send(ends[1], cycle(counts=100, left_ticks=500, right_ticks=-3, bumpers=0b1))
    send(ends[1], cycle(counts=101, left_ticks=21, right_ticks=-4, bumpers=0b100))
    readings = robot.sense(1.0)
    assert readings.infrared_counts == (101,) * 18
    assert (readings.encoder_left_ticks, readings.encoder_right_ticks) == (521, -7)
    assert readings.bumpers == 0b101  # a touch that ended within the tick counts in it
    later = robot.sense(1.01)
    assert (later.encoder_left_ticks, later.encoder_right_ticks) == (0, 0)
    assert later.bumpers == 0b100


def test_bits_beyond_the_bumper_table_are_no_bumpers(robot: Kurt2, ends: Ends) -> None:
    send(ends[1], cycle(bumpers=0b1100_0010))
    assert robot.sense(1.0).bumpers == 0b10


def test_the_age_is_that_of_the_oldest_frame(robot: Kurt2, ends: Ends) -> None:
    send(ends[1], cycle())
    assert robot.sense(1.0).infrared_age_s == 0.0
    for tick in range(1, 5):
        send(ends[1], cycle()[1:])
        readings = robot.sense(1.0 + tick * TICK_S)
        assert readings.infrared_age_s == pytest.approx(tick * TICK_S)
        assert readings.encoder_age_s == 0.0
    send(ends[1], cycle()[:1])
    readings = robot.sense(1.05)
    assert readings.infrared_age_s == pytest.approx(TICK_S)
    assert readings.encoder_age_s == pytest.approx(TICK_S)


def test_bumpers_that_fall_silent_age_until_the_robot_stands(robot: Kurt2, ends: Ends) -> None:
    send(ends[1], cycle(bumpers=0b10))
    robot.sense(1.0)
    reasons = []
    for tick in range(1, 13):
        now_s = 1.0 + tick * TICK_S
        send(ends[1], cycle()[:-1])
        readings = robot.sense(now_s)
        assert readings.bumper_age_s == pytest.approx(tick * TICK_S)
        assert readings.bumpers == 0b10  # what is not told is what was told last
        reasons.append(robot.drive(WheelSpeeds(-0.01, -0.01), now_s, now_s).reasons)
    assert reasons[:9] == [()] * 9
    assert reasons[-1] == (GuardReason.BUMPER_STALE,)
    send(ends[1], cycle())
    assert robot.sense(now_s).bumper_age_s == 0.0


def test_counts_above_10_bits_keep_the_old_value_and_age(robot: Kurt2, ends: Ends) -> None:
    send(ends[1], cycle(counts=200))
    robot.sense(1.0)
    send(ends[1], [CODEC.message("ADC04_07").pack(300, 300, 1024, 300), *cycle(counts=200)[2:]])
    readings = robot.sense(1.04)
    assert readings.infrared_counts == (200,) * 18
    assert readings.infrared_age_s == pytest.approx(0.04)
    assert robot.health.junk == 1
    send(ends[1], cycle(counts=1023))
    assert robot.sense(1.05).infrared_counts == (1023,) * 18


def test_unused_identifiers_are_filtered_out(robot: Kurt2, ends: Ends) -> None:
    send(ends[1], [CODEC.message("GYRO_MC1").pack(1, 2), CODEC.message("ADC12_15").pack(1, 2, 3, 4)])
    send(ends[1], [can.Message(arbitration_id=0x02, is_extended_id=False, data=b"12345678")])
    send(ends[1], [can.Message(arbitration_id=0x09, is_extended_id=True, data=b"12345678")])
    assert robot.sense(1.0).encoder_age_s == math.inf
    assert (robot.health.frames, robot.health.junk) == (0, 0)


HEARD = [0x05, 0x06, 0x07, 0x15, 0x16, 0x09, 0x0A]
JUNK = st.one_of(
    st.builds(
        can.Message,
        arbitration_id=st.sampled_from(HEARD),
        is_extended_id=st.just(False),
        is_remote_frame=st.just(True),
        dlc=st.integers(0, 8),
    ),
    st.builds(
        can.Message,
        arbitration_id=st.sampled_from([0x05, 0x06, 0x15, 0x16]),
        is_extended_id=st.just(False),
        data=st.binary(max_size=7) | st.binary(min_size=6, max_size=6).map(lambda rest: b"\x04\x00" + rest),
    ),
    st.builds(can.Message, arbitration_id=st.just(0x09), is_extended_id=st.just(False), data=st.binary(max_size=3)),
    st.builds(can.Message, arbitration_id=st.just(0x0A), is_extended_id=st.just(False), data=st.just(b"")),
)
STRANGERS = st.one_of(
    st.builds(
        can.Message,
        arbitration_id=st.integers(2, 0x7FF).filter(lambda frame_id: frame_id not in HEARD),
        is_extended_id=st.just(False),
        data=st.binary(max_size=8),
    ),
    st.builds(
        can.Message,
        arbitration_id=st.integers(0, 0x1FFF_FFFF) | st.integers(0, 0x20),
        is_extended_id=st.just(True),
        data=st.binary(max_size=8),
    ),
)


@given(st.lists(JUNK, max_size=10), st.lists(STRANGERS, max_size=5))
def test_junk_is_counted_and_changes_nothing(junk: list[can.Message], strangers: list[can.Message]) -> None:
    ends = bus_pair()
    robot = Kurt2(ROBOT, ends[0])
    send(ends[1], cycle(counts=222, left_ticks=7, right_ticks=8, bumpers=0b101))
    before = robot.sense(1.0)
    send(ends[1], [*junk, *strangers])
    after = robot.sense(1.02)
    assert (after.infrared_counts, after.bumpers) == (before.infrared_counts, before.bumpers)
    assert (after.encoder_left_ticks, after.encoder_right_ticks) == (0, 0)
    assert after.infrared_age_s == after.encoder_age_s == after.bumper_age_s == pytest.approx(0.02)
    assert (robot.health.junk, robot.health.frames) == (len(junk), len(junk) + len(cycle()))
    robot.close()
    ends[1].shutdown()


@pytest.mark.deep
@given(
    st.lists(
        st.builds(
            can.Message,
            arbitration_id=st.integers(2, 0x7FF) | st.integers(2, 0x20),
            is_extended_id=st.booleans(),
            is_remote_frame=st.booleans(),
            is_error_frame=st.booleans(),
            is_fd=st.booleans(),
            data=st.binary(max_size=64),
        ),
        max_size=200,
    )
)
def test_nothing_on_the_bus_brings_the_robot_down(messages: list[can.Message]) -> None:
    ends = bus_pair()
    robot = Kurt2(ROBOT, ends[0])
    stranger = InProcessBus(ends[0].name.removeprefix("virtual:"))  # a port of ours would refuse some
    for message in messages:
        stranger.send(message)
    stranger.shutdown()
    readings = robot.sense(1.0)
    assert all(0 <= counts <= 1023 for counts in readings.infrared_counts)
    assert robot.health.error_frames == sum(message.is_error_frame for message in messages)
    ends[1].drain()
    robot.drive(WheelSpeeds(0.3, 0.3), 1.0, 1.0)
    assert controls(ends[1])[-1] in (SpeedControl(Mode.SPEED_CM, 0, 0), BRAKE)
    robot.close()
    ends[1].shutdown()


def test_it_drives_through_the_guard(robot: Kurt2, ends: Ends) -> None:
    grant = GuardResult(STANDSTILL, (), latched=False)
    for tick in range(50):
        now_s = 1.0 + tick * TICK_S
        left_m_s, right_m_s = grant.wheel_speeds
        send(ends[1], cycle(left_ticks=ticks(left_m_s), right_ticks=ticks(right_m_s)))
        robot.sense(now_s)
        grant = robot.drive(WheelSpeeds(0.3, 0.2), now_s, now_s)
    assert grant.wheel_speeds == (0.3, 0.2)
    assert controls(ends[1])[-1] == SpeedControl(Mode.SPEED_CM, 30, 20)
    assert robot.drive(WheelSpeeds(0.3, 0.2), now_s - 1.0, now_s).reasons == (GuardReason.COMMAND_TOO_OLD,)
    robot.emergency_stop(GuardReason.SERVICE_ENDS)
    assert robot.health.latched == GuardReason.SERVICE_ENDS
    assert robot.drive(WheelSpeeds(0.3, 0.2), now_s, now_s).latched
    robot.release()
    assert not robot.drive(STANDSTILL, now_s, now_s).latched


def test_a_bus_that_goes_away_stops_the_robot_until_released(robot: Kurt2, ends: Ends) -> None:
    send(ends[1], cycle())
    robot.sense(1.0)
    pull_the_plug(ends[0])
    readings = robot.sense(1.01)
    assert readings.infrared_age_s == pytest.approx(0.01)
    assert robot.drive(WheelSpeeds(0.3, 0.3), 1.01, 1.01) == (STANDSTILL, (GuardReason.BUS_LOST,), True)
    assert robot.sense(1.02).infrared_age_s == pytest.approx(0.02)
    health = robot.health
    assert "receiving failed" in health.bus_trouble
    assert (health.latched, health.receive_failures, health.send_failures) == (GuardReason.BUS_LOST, 2, 2)

    robot.sense(2.02)  # a second later it opens the bus again
    send(ends[1], cycle(counts=300))
    assert robot.sense(2.03).infrared_counts == (300,) * 18
    assert robot.drive(WheelSpeeds(0.3, 0.3), 2.03, 2.03).latched
    assert controls(ends[1]) == [BRAKE]
    robot.release()
    assert not robot.drive(WheelSpeeds(0.3, 0.3), 2.03, 2.03).latched


def test_an_adapter_that_stays_away_is_looked_for_once_a_second(robot: Kurt2, ends: Ends) -> None:
    pull_the_plug(ends[0])
    name, ends[0].name = ends[0].name, "gone0"
    robot.sense(1.0)
    robot.sense(1.5)
    assert "receiving failed" in robot.health.bus_trouble
    robot.sense(2.0)
    robot.sense(2.5)
    assert "'gone0'" in robot.health.bus_trouble
    ends[0].name = name
    robot.sense(3.0)
    send(ends[1], cycle(counts=300))
    assert robot.sense(3.01).infrared_counts == (300,) * 18
    assert robot.health.receive_failures == 5


def test_closing_brakes_and_gives_the_bus_back_for_good() -> None:
    robot_end, far_end = bus_pair()
    robot = Kurt2(ROBOT, robot_end)
    robot.watchdog.start()
    robot.close()
    assert not robot.watchdog.running
    assert controls(far_end) == [BRAKE]
    assert robot.health.latched == GuardReason.CLOSED
    for now_s in (1.0, 3.0, 5.0):
        robot.sense(now_s)
    assert robot.health.receive_failures == 3
    far_end.shutdown()


@pytest.mark.parametrize(
    ("message", "fault"),
    [
        (' SG_ RIGHT : 23|16@0- (1,0) [-32768|32767] "ticks" NOTEBOOK\n', "ENCODER: its signals are LEFT; give it"),
        (' SG_ ADC08 : 7|16@0+ (1,0) [0|1023] "counts" NOTEBOOK\n', "no message carries ADC08; add"),
    ],
)
def test_database_without_a_signal_that_is_read_is_refused(
    ends: Ends, tmp_path: Path, message: str, fault: str
) -> None:
    path = tmp_path / "other.dbc"
    shipped = (CONFIG_DIR / "can/kurt2.dbc").read_text(encoding="cp1252")
    path.write_text("".join(shipped.split(message)), encoding="cp1252")
    can_settings = ROBOT.can.model_copy(update={"database": str(path)})
    with pytest.raises(CodecError, match=fault):
        Kurt2(ROBOT.model_copy(update={"can": can_settings}), ends[0])


def test_one_bus_has_one_robot(robot: Kurt2, ends: Ends) -> None:
    assert robot.health.latched is None
    with pytest.raises(BusError, match="taken"):
        Kurt2(ROBOT, ends[0])


def test_late_loop_stays_stopped_by_the_watchdog(ends: Ends) -> None:
    clock_s = 50.0
    kurt2 = Kurt2(ROBOT, ends[0], lambda: clock_s)
    with kurt2.watchdog:
        send(ends[1], cycle())
        kurt2.sense(1.0)
        assert not kurt2.drive(WheelSpeeds(0.2, 0.2), 1.0, 1.0).latched
        clock_s = 50.6
        send(ends[1], cycle())
        kurt2.sense(1.6)
        grant = kurt2.drive(WheelSpeeds(0.2, 0.2), 1.6, 1.6)
        assert grant.latched
        assert grant.reasons == (GuardReason.TICKS_CEASED,)
    kurt2.close()
