"""One message of each type, with values that show if a field is read from the wrong place."""

import numpy as np

from kurt2rt.ros.messages import (
    DiagnosticArray,
    DiagnosticStatus,
    Header,
    KeyValue,
    LaserScan,
    Odometry,
    Point,
    Pose,
    PoseWithCovariance,
    Quaternion,
    String,
    TFMessage,
    Time,
    Transform,
    TransformStamped,
    Twist,
    TwistStamped,
    TwistWithCovariance,
    Vector3,
)

HEADER = Header(Time(1_700_000_001, 250_000_000), "base_scan")
TWIST = Twist(Vector3(0.125, 0.0, 0.0), Vector3(0.0, 0.0, -1.5))
TURN = Quaternion(0.0, 0.0, 0.6, 0.8)
SCAN = LaserScan(
    HEADER,
    angle_min=0.0,
    angle_max=6.25,
    angle_increment=0.25,
    time_increment=0.5,
    scan_time=0.125,
    range_min=0.0625,
    range_max=3.5,
    ranges=np.array([0.5, np.inf, 2.25], dtype=np.float32),
    intensities=np.array([7.0], dtype=np.float32),
)
ODOMETRY = Odometry(
    HEADER,
    "base_footprint",
    PoseWithCovariance(Pose(Point(1.0, 2.0, 3.0), TURN), np.arange(36.0)),
    TwistWithCovariance(TWIST, np.arange(36.0, 72.0)),
)
DIAGNOSTICS = DiagnosticArray(HEADER, [DiagnosticStatus(2, "motors", "hot", "opencr", [KeyValue("degrees", "91")])])
TRANSFORMS = TFMessage([TransformStamped(HEADER, "base_link", Transform(Vector3(1.0, 2.0, 3.0), TURN))])
ALL = (SCAN, ODOMETRY, TWIST, TwistStamped(HEADER, TWIST), DIAGNOSTICS, TRANSFORMS, String("wall ahead, 0.3 m"))
