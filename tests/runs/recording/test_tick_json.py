"""Every tick comes back from its entry as it was, to the last bit."""

from typing import Any, NamedTuple, get_args

import pytest
from hypothesis import given
from hypothesis import strategies as some

from hal.robot import WheelSpeeds
from kurt2rt.core.decision.goal import NamedGoal, PartialGoal, RlaGoal
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.core.teaching.commands import Command, Seek
from kurt2rt.core.teaching.inbox import Input, SystemEvent
from kurt2rt.runs.recording.entries import TickEntry
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.recording.tick_json import _decoder, decode_command, decode_tick, encode_command, encode_tick
from tests.core.rla.helpers import deleted
from tests.strategies import EVENTS, values_of

COMMANDS = (*get_args(Command), *get_args(SystemEvent))

number = some.floats(allow_nan=False)
text = some.just(BASIC) | some.text(some.characters(codec="utf-8"), max_size=8)
# Half a surrogate pair cannot stand in a journal, so no teacher's command has one.
commands = some.sampled_from(COMMANDS).flatmap(some.from_type).filter(lambda command: "nan" not in repr(command))
PLAIN: dict[Any, some.SearchStrategy[Any]] = {
    bool: some.booleans(),
    int: some.integers(-(2**40), 2**40),
    float: number,
    str: text,
    Input: commands,
    TeachingEvent: EVENTS,
}
entries = values_of(TickEntry, PLAIN.get)


@given(entries)
def test_a_tick_comes_back_as_it_was(entry: TickEntry) -> None:
    again = decode_tick(encode_tick(entry))
    assert again == entry
    assert repr(again) == repr(entry)  # 0.0 is equal to -0.0, and 1 to 1.0


@given(entries)
def test_an_event_that_could_not_be_read_back_is_refused(entry: TickEntry) -> None:
    with pytest.raises(RecordingError, match=r"cannot be written: .*rla_id"):
        encode_tick(entry._replace(events=(deleted(0),)))


@given(commands)
def test_every_command_comes_back_as_it_was(command: object) -> None:
    assert decode_command(encode_command(command)) == command  # type: ignore[arg-type]


@pytest.mark.parametrize("goal", [NamedGoal("door"), RlaGoal(3), PartialGoal((("wall_left", 1.0), ("x", 0.1)), 0.5)])
def test_a_goal_keeps_its_kind(goal: NamedGoal | RlaGoal | PartialGoal) -> None:
    seek = Seek("s", "Ann", goal, 7)
    assert decode_command(encode_command(seek)) == seek


def test_a_reading_of_before_a_field_has_its_default() -> None:
    class NewReadings(NamedTuple):
        time_s: float
        turned: WheelSpeeds = WheelSpeeds(0.5, 0.0)
        compass: float | None = 3.0  # None is left out

    assert _decoder(NewReadings)({"time_s": 1.0}) == (1.0, (0.5, 0.0), None)


def test_decode_tick_of_other_content_raises_recording_error() -> None:
    for data in (b"", b"[]", b"{}", b'{"tick": 1}', b"\xff"):
        with pytest.raises(RecordingError, match="not a tick"):
            decode_tick(data)


def test_an_unknown_command_is_named() -> None:
    with pytest.raises(RecordingError, match="'Dance'"):
        decode_command({"is": "Dance"})


def test_a_command_with_a_wrong_field_names_it() -> None:
    with pytest.raises(RecordingError, match="Drive: press_id"):
        decode_command(
            {"is": "Drive", "teacher": "Ann", "seen_tick": 1, "press_id": "x", "left_m_s": 0, "right_m_s": 0}
        )
