"""The robot as ROS 2 messages: scan, odometry, transform, diagnostics."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from hal.odometry import PlanePose
from kurt2rt.channel.protocol.health import Trouble
from kurt2rt.channel.protocol.hello import Hello
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.decision.decision import Severity
from kurt2rt.ros import messages as ros
from kurt2rt.teacher.client.link_quality import LinkQuality
from kurt2rt.teacher.terminal.terminal_text import format_state


class WheelPose(NamedTuple):
    """Dead-reckoned pose since the device began, and the speeds of the newest step, for /odom."""

    pose: PlanePose
    forward_m_s: float
    turn_rad_s: float


class Odometer:
    """Dead reckoning by the ways of both sides, which the robot sums up, so that a lost state loses no way."""

    def __init__(self) -> None:
        """Start at (0, 0, 0)."""
        self._pose = PlanePose()
        self._newest: State | None = None

    def update(self, state: State, track_m: float, period_s: float) -> WheelPose:
        """Return the pose after a state. A restarted robot goes on where it was.

        `track_m`: distance of the sides in m; `period_s`: duration of a tick in s.
        """
        before, self._newest = self._newest, state
        if before is None or before.boot != state.boot or state.tick <= before.tick:
            return WheelPose(self._pose, 0.0, 0.0)
        left_m, right_m = state.way_m[0] - before.way_m[0], state.way_m[1] - before.way_m[1]
        forward_m, turn_rad = (left_m + right_m) / 2, (right_m - left_m) / track_m
        moved = self._pose.moved(forward_m, turn_rad)
        self._pose = moved._replace(heading_rad=math.remainder(moved.heading_rad, math.tau))
        took_s = (state.tick - before.tick) * period_s
        return WheelPose(self._pose, forward_m / took_s, turn_rad / took_s)


ODOM, BASE = "odom", "base_link"
"""Frames: where the device began, by the encoders; the robot's centre."""

RAYS = 360
"""Rays of a scan: more than sensors, because a hit is seen from the robot's centre in another direction each time."""
_STEP_RAD = math.tau / RAYS
_UNMEASURED = 1e6
"""Variance of what wheels on a plane do not measure, in m2 or rad2."""
_PLACE_M2, _HEADING_RAD2 = 0.01, 0.05
"""Variances of the pose: of this order after some metres, for skidding wheels drift without bound."""
_SPEED_M2_S2, _TURN_RAD2_S2 = 0.0004, 0.02
"""Variances of the speeds, from the resolution of the encoders over 50 ms and from the skidding."""

_LOST_AFTER_S = 0.5


class ScanBuilder:
    """Builder of a LaserScan from the centre of the robot out of the readings of its distance sensors.

    A hit stands at its true place, in the ray that is nearest to it. A sensor that sees nothing gives infinity,
    and a direction into which no sensor looks NaN (REP 117).
    """

    def __init__(self, hello: Hello) -> None:
        """`hello`: the robot's introduction, with the law of its sensors."""
        self._law = hello.law
        self._sensors = [
            (each.x_m, each.y_m, math.cos(heading_rad), math.sin(heading_rad))
            for each in hello.sensors
            for heading_rad in [math.radians(each.heading_deg)]
        ]
        self._reach_m = hello.law.far_m + max((math.hypot(each.x_m, each.y_m) for each in hello.sensors), default=0.0)

    def build(self, counts: Sequence[int], stamp: ros.Time) -> ros.LaserScan:
        """Return the scan of readings in counts, one per sensor."""
        ranges = np.full(RAYS, math.nan, np.float32)
        for (x_m, y_m, dx, dy), count in zip(self._sensors, counts, strict=False):
            away_m = self._law.distance_m(count)
            hit_x_m, hit_y_m = x_m + away_m * dx, y_m + away_m * dy
            ray = round((math.atan2(hit_y_m, hit_x_m) + math.pi) / _STEP_RAD) % RAYS
            seen = self._law.detects(count) and away_m < self._law.far_m
            ranges[ray] = np.fmin(ranges[ray], math.hypot(hit_x_m, hit_y_m) if seen else math.inf)
        return ros.LaserScan(
            header=ros.Header(stamp, BASE),
            angle_min=-math.pi,
            angle_max=math.pi - _STEP_RAD,
            angle_increment=_STEP_RAD,
            time_increment=0.0,
            scan_time=0.0,
            range_min=0.0,
            range_max=self._reach_m,
            ranges=ranges,
            intensities=np.zeros(0, np.float32),
        )


def odometry(place: WheelPose, stamp: ros.Time) -> ros.Odometry:
    """Return the robot's pose and speeds by the encoders, for /odom."""
    pose = place.pose
    return ros.Odometry(
        header=ros.Header(stamp, ODOM),
        child_frame_id=BASE,
        pose=ros.PoseWithCovariance(
            ros.Pose(ros.Point(pose.x_m, pose.y_m, 0.0), _turned(pose.heading_rad)),
            _covariance(_PLACE_M2, _PLACE_M2, _HEADING_RAD2),
        ),
        twist=ros.TwistWithCovariance(
            ros.Twist(ros.Vector3(place.forward_m_s, 0.0, 0.0), ros.Vector3(0.0, 0.0, place.turn_rad_s)),
            _covariance(_SPEED_M2_S2, _SPEED_M2_S2, _TURN_RAD2_S2),
        ),
    )


def transform(pose: PlanePose, stamp: ros.Time) -> ros.TFMessage:
    """Return the robot's pose in the odometry's frame, for /tf."""
    moved = ros.Transform(ros.Vector3(pose.x_m, pose.y_m, 0.0), _turned(pose.heading_rad))
    return ros.TFMessage([ros.TransformStamped(ros.Header(stamp, ODOM), BASE, moved)])


def robot_status(state: State, hello: Hello) -> ros.DiagnosticStatus:
    """Return a diagnostic status of the robot: a warning if it waits for its teacher, an error if it has a fault."""
    severity = state.standing.reason.severity
    level = ros.DiagnosticStatus.ERROR if state.trouble and severity is Severity.FINE else int(severity)
    return status(
        level,
        f"{hello.robot}: robot",
        format_state(state) or "drives",
        hello.robot,
        task=hello.task,
        behaviour=state.behaviour,
        phase=hello.phases[state.phase - 1] if state.phase <= len(hello.phases) else state.phase,
        teacher=state.teacher or "",
        action=state.action or "",
        rla="" if state.rla is None else state.rla,
        rlas=state.rlas,
        lessons=state.lessons,
        unsaved=state.unsaved,
        guard=", ".join(state.guard),
        trouble=state.trouble,
        infrared_age_s=round(state.infrared_age_s, 3),
        bumpers=f"{state.bumpers:b}",
        late_p99_ms=round(state.late_p99_ms, 2),
        missed_ticks=state.missed_ticks,
        tick=state.tick,
    )


def link_status(link: LinkQuality, trouble: str, age_s: float, robot: str) -> ros.DiagnosticStatus:
    """Return a diagnostic status of the channel to the robot; `age_s` of the newest state in s."""
    lost = age_s > _LOST_AFTER_S
    level = ros.DiagnosticStatus.ERROR if lost else ros.DiagnosticStatus.OK
    message = (trouble or "no state comes from the robot") if lost else "states come in"
    return status(
        level,
        f"{robot}: teacher's channel",
        message,
        robot,
        state_age_s="" if math.isinf(age_s) else round(age_s, 3),
        states_per_s=round(link.states_per_s, 1),
        round_trip_ms="" if link.rtt_ms is None else round(link.rtt_ms, 1),
        answered="" if link.answered is None else round(link.answered, 3),
    )


def trouble_status(trouble: Trouble, robot: str) -> ros.DiagnosticStatus:
    """Return a diagnostic status of one fault of robot, program or machine."""
    level = ros.DiagnosticStatus.ERROR if trouble.urgent else ros.DiagnosticStatus.WARN
    return status(level, f"{robot}: {trouble.about}", trouble.what, robot, to_do=trouble.to_do)


def status(level: int, name: str, message: str, hardware: str, **values: object) -> ros.DiagnosticStatus:
    """Return a diagnostic status with these values as texts."""
    pairs = [ros.KeyValue(key, str(value)) for key, value in values.items()]
    return ros.DiagnosticStatus(level, name, message, hardware, pairs)


def _covariance(x: float, y: float, heading: float) -> "np.ndarray[tuple[int, ...], np.dtype[np.float64]]":
    return np.diag([x, y, _UNMEASURED, _UNMEASURED, _UNMEASURED, heading]).reshape(-1)


def _turned(heading_rad: float) -> ros.Quaternion:
    return ros.Quaternion(0.0, 0.0, math.sin(heading_rad / 2), math.cos(heading_rad / 2))
