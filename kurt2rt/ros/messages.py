"""ROS 2 messages as CDR bytes, by rosbags' definitions; these types are equal in Humble, Jazzy and later."""

import struct
from typing import ClassVar, Final, Protocol, TypeVar

from rosbags.interfaces import Nodetype
from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.stores import ros2_jazzy as ros

Time = ros.builtin_interfaces__msg__Time
Header = ros.std_msgs__msg__Header
String = ros.std_msgs__msg__String
LaserScan = ros.sensor_msgs__msg__LaserScan
Odometry = ros.nav_msgs__msg__Odometry
Point = ros.geometry_msgs__msg__Point
Pose = ros.geometry_msgs__msg__Pose
PoseWithCovariance = ros.geometry_msgs__msg__PoseWithCovariance
Quaternion = ros.geometry_msgs__msg__Quaternion
Transform = ros.geometry_msgs__msg__Transform
TransformStamped = ros.geometry_msgs__msg__TransformStamped
Twist = ros.geometry_msgs__msg__Twist
TwistStamped = ros.geometry_msgs__msg__TwistStamped
TwistWithCovariance = ros.geometry_msgs__msg__TwistWithCovariance
Vector3 = ros.geometry_msgs__msg__Vector3
DiagnosticArray = ros.diagnostic_msgs__msg__DiagnosticArray
DiagnosticStatus = ros.diagnostic_msgs__msg__DiagnosticStatus
KeyValue = ros.diagnostic_msgs__msg__KeyValue
TFMessage = ros.tf2_msgs__msg__TFMessage

TRIGGER: Final = "std_srvs/srv/Trigger"
_RESPONSE = f"{TRIGGER}_Response"
EMPTY_REQUEST: Final = bytes((0, 1, 0, 0, 0))
"""Trigger's request: CDR header and the byte that IDL gives a structure without members."""

_TRIGGER_HASH = "RIHS01_eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f"
"""Hash of the service with its event message, which rosbags' definition of that message does not give."""
_NANOSECONDS = 1_000_000_000
_STORE = get_typestore(Stores.ROS2_JAZZY)
_STORE.register(
    {_RESPONSE: ([], [("success", (Nodetype.BASE, ("bool", 0))), ("message", (Nodetype.BASE, ("string", 0)))])}
)


class InvalidMessageError(ValueError):
    """Received bytes that are no message of the expected type, or a message that makes no sense."""


class Message(Protocol):
    """Any ROS 2 message class of this module, with its type's name."""

    __msgtype__: ClassVar[str]


MessageT = TypeVar("MessageT", bound=Message)


def encode(message: Message) -> bytes:
    """Return a message as little-endian CDR, header included.

    Raises InvalidMessageError if a field is of another type, or a number does not fit.
    """
    return _encode(message, message.__msgtype__)


def decode(payload: bytes, kind: type[MessageT]) -> MessageT:
    """Return the message of class `kind` in CDR bytes, which may be hostile; arrays are read-only, of shape (n,).

    Raises InvalidMessageError for anything else than one whole message of that class.
    """
    message = _decode(payload, kind.__msgtype__)
    assert isinstance(message, kind)
    return message


def encode_trigger_response(success: bool, text: str) -> bytes:
    """Return the response of a std_srvs/srv/Trigger service as CDR. Raises InvalidMessageError."""
    return _encode(_STORE.types[_RESPONSE](success, text), _RESPONSE)


def decode_trigger_response(payload: bytes) -> tuple[bool, str]:
    """Return success and text of a response of a std_srvs/srv/Trigger service. Raises InvalidMessageError."""
    response = _decode(payload, _RESPONSE)
    return getattr(response, "success"), getattr(response, "message")  # noqa: B009 - the class is made at run time


def type_hash(type_name: str) -> str:
    """Return REP-2016's hash of a type such as "sensor_msgs/msg/LaserScan". Raises KeyError for an unknown type."""
    return _TRIGGER_HASH if type_name == TRIGGER else _STORE.hash_rihs01(type_name)


def to_time(time_s: float) -> Time:
    """Return a time stamp from seconds of any epoch, at least 0."""
    nanoseconds = round(time_s * _NANOSECONDS)
    return Time(nanoseconds // _NANOSECONDS, nanoseconds % _NANOSECONDS)


def to_seconds(stamp: Time) -> float:
    """Return a time stamp in s."""
    return stamp.sec + stamp.nanosec / _NANOSECONDS


def _encode(message: object, type_name: str) -> bytes:
    try:
        return bytes(_STORE.serialize_cdr(message, type_name))
    except (SerdeError, struct.error) as error:
        raise InvalidMessageError(f"{type_name}: {error}") from error


def _decode(payload: bytes, type_name: str) -> object:
    try:
        return _STORE.deserialize_cdr(payload, type_name)
    except SerdeError as error:
        raise InvalidMessageError(f"{type_name}: {error} (got {len(payload)} bytes)") from error
