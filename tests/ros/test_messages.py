"""ROS 2 messages: CDR that an independent library writes and reads too; hostile bytes give one kind of error."""

import dataclasses
import math
from contextlib import suppress
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore

from kurt2rt.ros.messages import (
    EMPTY_REQUEST,
    TRIGGER,
    InvalidMessageError,
    LaserScan,
    Message,
    Odometry,
    Twist,
    Vector3,
    decode,
    decode_trigger_response,
    encode,
    encode_trigger_response,
    to_seconds,
    to_time,
    type_hash,
)
from tests.ros import examples, foreign

SHORT_NAMES = [message.__msgtype__.rpartition("/")[2] for message in examples.ALL]


def plain(value: Any) -> Any:
    """Return a message of either library as lists, numbers and texts, in the order of its fields."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        names = [each.name for each in dataclasses.fields(value) if each.name != "__msgtype__"]
        return [plain(getattr(value, name)) for name in names if not name.isupper()]  # constants are no fields
    if isinstance(value, np.ndarray | list | tuple):
        return [plain(each) for each in value]
    return value


@pytest.mark.parametrize("message", examples.ALL, ids=SHORT_NAMES)
def test_encode_each_type_is_read_by_another_library(message: Message) -> None:
    kind = getattr(foreign, message.__msgtype__.rpartition("/")[2])
    assert plain(kind.deserialize(encode(message))) == plain(message)


@pytest.mark.parametrize("message", examples.ALL, ids=SHORT_NAMES)
def test_decode_bytes_of_another_library_is_right(message: Message) -> None:
    kind = getattr(foreign, message.__msgtype__.rpartition("/")[2])
    written = kind.deserialize(encode(message)).serialize()
    assert plain(decode(written, type(message))) == plain(message)


def test_trigger_response_is_read_by_another_library() -> None:
    read = foreign.TriggerResponse.deserialize(encode_trigger_response(True, "robot stands"))
    assert (read.success, read.message) == (True, "robot stands")
    assert decode_trigger_response(foreign.TriggerResponse(False, "no").serialize()) == (False, "no")


@pytest.mark.parametrize("message", examples.ALL, ids=SHORT_NAMES)
def test_decode_each_truncation_is_refused(message: Message) -> None:
    payload = encode(message)
    for length in range(len(payload)):
        with pytest.raises(InvalidMessageError, match=message.__msgtype__):
            decode(payload[:length], type(message))


@settings(max_examples=300)
@given(st.sampled_from(examples.ALL), st.data())
def test_decode_hostile_bytes_raises_one_kind_of_error(message: Message, data: st.DataObject) -> None:
    payload = bytearray(encode(message))
    for place in data.draw(st.lists(st.integers(0, len(payload) - 1), max_size=8)):
        payload[place] = data.draw(st.sampled_from([0, 1, 0x7F, 0x80, 0xFF]))
    with suppress(InvalidMessageError):
        decode(bytes(payload), type(message))


@given(st.binary(max_size=200))
def test_decode_random_bytes_raises_one_kind_of_error(payload: bytes) -> None:
    for kind in (LaserScan, Odometry, Twist):
        with suppress(InvalidMessageError):
            decode(b"\0\1\0\0" + payload, kind)


def test_encode_text_in_place_of_a_number_is_refused() -> None:
    wrong: Any = "fast"
    with pytest.raises(InvalidMessageError, match="geometry_msgs/msg/Twist"):
        encode(Twist(Vector3(wrong, 0.0, 0.0), Vector3(0.0, 0.0, 0.0)))


def test_type_hash_of_trigger_follows_from_its_fields() -> None:
    store = get_typestore(Stores.ROS2_JAZZY)
    info = store.fielddefs["service_msgs/msg/ServiceEventInfo"]
    # `char` of a .msg file is uint8 in IDL, of which the hash is made.
    fields = [
        (n, (Nodetype.ARRAY, ((Nodetype.BASE, ("uint8", 0)), 16)) if n == "client_gid" else t) for n, t in info[1]
    ]
    part_of: Any = {part: (Nodetype.NAME, f"{TRIGGER}_{part}") for part in ("Request", "Response", "Event")}
    fielddefs: Any = store.fielddefs
    fielddefs["service_msgs/msg/ServiceEventInfo"] = (info[0], fields)
    store.register(
        {
            f"{TRIGGER}_Request": ([], []),
            f"{TRIGGER}_Response": (
                [],
                [("success", (Nodetype.BASE, ("bool", 0))), ("message", (Nodetype.BASE, ("string", 0)))],
            ),
            f"{TRIGGER}_Event": (
                [],
                [
                    ("info", (Nodetype.NAME, "service_msgs/msg/ServiceEventInfo")),
                    ("request", (Nodetype.SEQUENCE, (part_of["Request"], 1))),
                    ("response", (Nodetype.SEQUENCE, (part_of["Response"], 1))),
                ],
            ),
            TRIGGER: (
                [],
                [
                    ("request_message", part_of["Request"]),
                    ("response_message", part_of["Response"]),
                    ("event_message", part_of["Event"]),
                ],
            ),
        }
    )
    assert type_hash(TRIGGER) == store.hash_rihs01(TRIGGER)
    assert len(EMPTY_REQUEST) == 5


@given(st.floats(0, 2**31 - 1))
def test_time_in_seconds_comes_back_within_a_microsecond(time_s: float) -> None:
    assert math.isclose(to_seconds(to_time(time_s)), time_s, abs_tol=1e-6)
