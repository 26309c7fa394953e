"""ROS 2 messages: CDR that an independent library writes and reads too; hostile bytes give one kind of error."""

import dataclasses
from contextlib import suppress
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kurt2rt.ros.messages import InvalidMessageError, Message, Twist, Vector3, decode, encode
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


def test_encode_text_in_place_of_a_number_is_refused() -> None:
    wrong: Any = "fast"
    with pytest.raises(InvalidMessageError, match="geometry_msgs/msg/Twist"):
        encode(Twist(Vector3(wrong, 0.0, 0.0), Vector3(0.0, 0.0, 0.0)))
