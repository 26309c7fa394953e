"""The messages in an independent library: pycdr2 (BSD, of the CycloneDDS project), written from the .msg files."""

from dataclasses import dataclass, field

from pycdr2 import IdlStruct
from pycdr2.types import array, float32, float64, int32, sequence, uint8, uint32


@dataclass
class Time(IdlStruct):
    sec: int32 = 0
    nanosec: uint32 = 0


@dataclass
class Header(IdlStruct):
    stamp: Time = field(default_factory=Time)
    frame_id: str = ""


@dataclass
class LaserScan(IdlStruct):
    header: Header
    angle_min: float32
    angle_max: float32
    angle_increment: float32
    time_increment: float32
    scan_time: float32
    range_min: float32
    range_max: float32
    ranges: sequence[float32]
    intensities: sequence[float32]


@dataclass
class Vector3(IdlStruct):
    x: float64 = 0.0
    y: float64 = 0.0
    z: float64 = 0.0


@dataclass
class Twist(IdlStruct):
    linear: Vector3
    angular: Vector3


@dataclass
class TwistStamped(IdlStruct):
    header: Header
    twist: Twist


@dataclass
class Quaternion(IdlStruct):
    x: float64
    y: float64
    z: float64
    w: float64


@dataclass
class Pose(IdlStruct):
    position: Vector3
    orientation: Quaternion


@dataclass
class PoseWithCovariance(IdlStruct):
    pose: Pose
    covariance: array[float64, 36]


@dataclass
class TwistWithCovariance(IdlStruct):
    twist: Twist
    covariance: array[float64, 36]


@dataclass
class Odometry(IdlStruct):
    header: Header
    child_frame_id: str
    pose: PoseWithCovariance
    twist: TwistWithCovariance


@dataclass
class Transform(IdlStruct):
    translation: Vector3
    rotation: Quaternion


@dataclass
class TransformStamped(IdlStruct):
    header: Header
    child_frame_id: str
    transform: Transform


@dataclass
class TFMessage(IdlStruct):
    transforms: sequence[TransformStamped]


@dataclass
class KeyValue(IdlStruct):
    key: str
    value: str


@dataclass
class DiagnosticStatus(IdlStruct):
    level: uint8
    name: str
    message: str
    hardware_id: str
    values: sequence[KeyValue]


@dataclass
class DiagnosticArray(IdlStruct):
    header: Header
    status: sequence[DiagnosticStatus]


@dataclass
class String(IdlStruct):
    data: str
