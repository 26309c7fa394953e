"""A frame in 16 bytes: there and back, and as python-can lays it out."""

import can
import pytest
from can.interfaces.socketcan.socketcan import build_can_frame
from hypothesis import given
from hypothesis import strategies as some

from hal.bus_frame import BUS_FRAME, frame_of, is_heard, pack_bus_frame
from hal.frame import Frame
from tests.hal.bus_conformance import BUS_OFF, EXTENDED, REMOTE, identity

payloads = some.binary(max_size=8)
data_frames = some.builds(Frame, some.integers(0, 0x7FF), payloads)
extended_frames = some.builds(
    lambda frame_id, data: can.Message(arbitration_id=frame_id, is_extended_id=True, data=data),
    some.integers(0, 0x1FFF_FFFF),
    payloads,
)
remote_frames = some.builds(
    lambda frame_id, dlc: can.Message(
        arbitration_id=frame_id, is_extended_id=False, is_remote_frame=True, dlc=dlc, data=None
    ),
    some.integers(0, 0x7FF),
    some.integers(0, 8),
)
error_frames = some.builds(
    lambda kind, data: can.Message(arbitration_id=kind, is_extended_id=False, is_error_frame=True, data=data),
    some.integers(0, 0x3FF),
    some.binary(min_size=8, max_size=8),
)
frames = data_frames | extended_frames | remote_frames | error_frames


@given(frames)
def test_a_frame_comes_back_as_it_was(frame: can.Message) -> None:
    assert identity(frame_of(*BUS_FRAME.unpack(pack_bus_frame(frame)))) == identity(frame)


@given(frames)
def test_the_layout_is_the_kernels(frame: can.Message) -> None:
    # python-can fills in len8_dlc too, which only lengths over 8 need.
    theirs = build_can_frame(frame)
    assert pack_bus_frame(frame) == theirs[:7] + b"\0" + theirs[8:]


@given(some.binary(min_size=16, max_size=16))
def test_any_16_bytes_are_some_frame_of_at_most_8_bytes(record: bytes) -> None:
    frame = frame_of(*BUS_FRAME.unpack(record))
    assert frame.dlc <= 8
    assert len(frame.data) <= 8
    assert 0 <= frame.arbitration_id <= (0x1FFF_FFFF if frame.is_extended_id else 0x7FF)


@pytest.mark.parametrize(
    "frame",
    [
        can.Message(arbitration_id=1, data=bytes(9)),
        can.Message(arbitration_id=1, is_fd=True, data=b""),
        can.Message(arbitration_id=1, is_remote_frame=True, dlc=9),
    ],
)
def test_packing_a_frame_that_is_not_classic_can_is_refused(frame: can.Message) -> None:
    with pytest.raises(ValueError, match="0x1 "):
        pack_bus_frame(frame)


def test_filter_passes_its_identifiers_and_all_errors() -> None:
    assert is_heard(EXTENDED, None)
    assert is_heard(REMOTE, frozenset({REMOTE.arbitration_id}))
    assert not is_heard(REMOTE, frozenset())
    assert not is_heard(EXTENDED, frozenset({EXTENDED.arbitration_id}))
    assert is_heard(BUS_OFF, frozenset())
