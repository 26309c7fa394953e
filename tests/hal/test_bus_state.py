"""State of the adapter from its error frames, and its one-line text."""

import can
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hal.bus_state import BusState, ControllerState
from tests.hal.helpers import error_frame


@pytest.fixture
def state() -> BusState:
    return BusState("can0")


def test_at_first_all_is_well(state: BusState) -> None:
    assert state.controller is ControllerState.ACTIVE
    assert (state.trouble, state.error_frames, state.kinds) == ("", 0, {})


@pytest.mark.parametrize(
    ("status", "controller"),
    [
        (0x04, ControllerState.WARNING),
        (0x08, ControllerState.WARNING),
        (0x0C, ControllerState.WARNING),
        (0x10, ControllerState.PASSIVE),
        (0x20, ControllerState.PASSIVE),
        (0x24, ControllerState.PASSIVE),
        (0x40, ControllerState.ACTIVE),
    ],
)
def test_the_controllers_status_is_its_state(state: BusState, status: int, controller: ControllerState) -> None:
    state.note(error_frame(0x004, status=status))
    assert state.controller is controller


def test_a_status_of_another_class_says_nothing(state: BusState) -> None:
    state.note(error_frame(0x008, status=0x30))
    assert state.controller == "error-active"
    state.note(error_frame(0x004, status=0x10))
    state.note(error_frame(0x004, status=0x02))  # an overflow alone is no state
    assert state.controller == "error-passive"


def test_warned_then_passive_then_well_again(state: BusState) -> None:
    for status in (0x08, 0x20, 0x08, 0x40):
        state.note(error_frame(0x204, status=status, sending=100, receiving=3))
    assert state.trouble == ""
    assert (state.sending_errors, state.receiving_errors) == (100, 3)


def test_a_passive_controller_says_what_it_suffers_from(state: BusState) -> None:
    for _ in range(3):
        state.note(error_frame(0x020))
    state.note(error_frame(0x088))
    state.note(error_frame(0x008))
    state.note(error_frame(0x204, status=0x20, sending=128, receiving=7))
    assert (state.controller, state.sending_errors, state.receiving_errors) == (ControllerState.PASSIVE, 128, 7)
    assert state.kinds == {"not acknowledged": 3, "broken": 2}
    assert state.error_frames == 6


def test_a_warning_without_a_kind_says_how_many_there_were(state: BusState) -> None:
    state.note(error_frame(0x004, status=0x04, sending=1, receiving=96))
    assert (state.sending_errors, state.receiving_errors, state.kinds) == (1, 96, {})
    assert state.trouble.endswith(": 1")


def test_each_kind_is_counted(state: BusState) -> None:
    for classes in (0x001, 0x002, 0x002, 0x008, 0x080, 0x010, 0x020):
        state.note(error_frame(classes))
    for status in (0x01, 0x02, 0x03):
        state.note(error_frame(0x004, status=status))
    assert state.kinds == {
        "not acknowledged": 1,
        "broken": 2,
        "transceiver": 1,
        "not sent in time": 1,
        "lost arbitration": 2,
        "overflow": 3,
    }


def test_bus_off_is_the_state_of_a_controller_that_left(state: BusState) -> None:
    state.note(error_frame(0x040))
    assert state.off
    assert state.controller is ControllerState.OFF
    assert state.trouble.startswith("bus can0: ")


def test_a_restarted_controller_is_back(state: BusState) -> None:
    state.note(error_frame(0x040))
    state.note(error_frame(0x100))
    assert (state.off, state.trouble) == (False, "")


def test_bus_off_during_restart_stays_off(state: BusState) -> None:
    state.note(error_frame(0x140))
    assert state.off


def test_traffic_ends_bus_off_but_not_a_warning(state: BusState) -> None:
    state.note(error_frame(0x040))
    state.note_traffic()
    assert state.controller == "error-active"
    state.note(error_frame(0x004, status=0x10))
    state.note_traffic()
    assert state.controller == "error-passive"


@pytest.mark.parametrize("classes", [0x004, 0x200, 0x204])
def test_counters_are_read_where_kernels_put_them(state: BusState, classes: int) -> None:
    state.note(error_frame(classes, sending=200, receiving=90))
    assert (state.sending_errors, state.receiving_errors) == (200, 90)


@pytest.mark.parametrize("classes", [0x008, 0x040, 0x100])
def test_elsewhere_they_are_not_counters(state: BusState, classes: int) -> None:
    state.note(error_frame(classes, sending=200, receiving=90))
    assert (state.sending_errors, state.receiving_errors) == (0, 0)


def test_a_short_error_frame_has_no_details(state: BusState) -> None:
    state.note(can.Message(arbitration_id=0x204, is_extended_id=False, is_error_frame=True, data=b"\0\x30\0\0\0\0\x80"))
    assert (state.controller, state.sending_errors) == (ControllerState.ACTIVE, 0)
    assert state.error_frames == 1


@given(st.lists(st.builds(error_frame, st.integers(0, 0x1FFF_FFFF), status=st.integers(0, 255)), max_size=50))
def test_bus_state_counts_each_kind_of_frame_in_one_line(frames: list[can.Message]) -> None:
    state = BusState("can0")
    for frame in frames:
        state.note(frame)
        assert "\n" not in state.trouble
        assert bool(state.trouble) == (state.controller is not ControllerState.ACTIVE)
    assert state.error_frames == len(frames)
