"""The robot as ROS 2 messages, read by a second CDR library."""

import math
from typing import Any

import pytest

from hal.robot_settings import load_robot
from kurt2rt.channel.protocol.hello import Hello
from kurt2rt.channel.server.channel import describe_robot
from kurt2rt.core.decision.decision import StandReason
from kurt2rt.core.decision.standing import Standing
from kurt2rt.ros import messages as ros
from kurt2rt.teacher.ros.robot_messages import Odometer, ScanBuilder, robot_status
from tests.channel.channel_fixture import BOOT, ChannelFixture
from tests.channel.states import state
from tests.ros import foreign

STAMP = ros.to_time(12.5)
INFRARED = load_robot().infrared


def read_by_another(kind: Any, message: ros.Message) -> Any:
    """Return a message as the second library reads it; its types are made at run time."""
    return kind.deserialize(ros.encode(message))


@pytest.fixture(scope="module")
def hello() -> Hello:
    return describe_robot(ChannelFixture().runtime, BOOT, simulated=True)


def counts(**seen_m: float) -> tuple[int, ...]:
    """Return readings with obstacles at these distances from some sensors."""
    return tuple(round(INFRARED.counts_at(seen_m[name])) if name in seen_m else 20 for name in INFRARED.names)


def test_scan_has_each_hit_where_the_sensor_sees_it(hello: Hello) -> None:
    builder = ScanBuilder(hello)
    for sensor in INFRARED.sensors:
        scan = read_by_another(foreign.LaserScan, builder.build(counts(**{sensor.name: 0.3}), STAMP))
        (ray,) = [number for number, range_m in enumerate(scan.ranges) if math.isfinite(range_m)]
        angle_rad = scan.angle_min + ray * scan.angle_increment
        heading_rad = math.radians(sensor.heading_deg)
        x_m, y_m = sensor.x_m + 0.3 * math.cos(heading_rad), sensor.y_m + 0.3 * math.sin(heading_rad)
        found = scan.ranges[ray] * math.cos(angle_rad), scan.ranges[ray] * math.sin(angle_rad)
        assert found == pytest.approx((x_m, y_m), abs=0.012), sensor.name
        assert scan.ranges[ray] < scan.range_max


@pytest.mark.parametrize(
    ("standing", "trouble", "level"),
    [
        (Standing(), "", ros.DiagnosticStatus.OK),
        (Standing(StandReason.ASKS, asks=True), "", ros.DiagnosticStatus.WARN),
        (Standing(StandReason.BUS_LOST, needs_resume=True), "", ros.DiagnosticStatus.ERROR),
        (Standing(StandReason.BLIND), "", ros.DiagnosticStatus.ERROR),
        (Standing(), "the disk is full; make room", ros.DiagnosticStatus.ERROR),
    ],
)
def test_status_of_robot_has_a_level(hello: Hello, standing: Standing, trouble: str, level: int) -> None:
    told = robot_status(state(standing=standing, trouble=trouble, action="forward"), hello)
    array = ros.DiagnosticArray(ros.Header(STAMP, ""), [told])
    (read,) = read_by_another(foreign.DiagnosticArray, array).status
    assert read.level == level
    values = {each.key: each.value for each in read.values}
    assert (values["task"], values["tick"], values["trouble"]) == ("wall_following", "1234", trouble)


def test_odometer_follows_an_arc_over_lost_states() -> None:
    odometer = Odometer()
    odometer.update(state(tick=0, way_m=(0.0, 0.0)), 0.4, 0.01)
    quarter_m = math.pi / 2
    place = odometer.update(state(tick=100, way_m=(0.8 * quarter_m, 1.2 * quarter_m)), 0.4, 0.01)
    assert place is not None
    assert place.pose.heading_rad == pytest.approx(math.pi / 2)
    assert (place.forward_m_s, place.turn_rad_s) == pytest.approx((quarter_m, math.pi / 2))
