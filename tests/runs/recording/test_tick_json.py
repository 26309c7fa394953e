"""Every tick comes back from its entry as it was, to the last bit."""

from typing import NamedTuple, get_args

import pytest
from hypothesis import given
from hypothesis import strategies as some

from hal.guard_reason import GuardReason
from hal.robot import GuardResult, SensorReadings, WheelSpeeds
from kurt2rt.core.decision.decision import DecisionCause, GoalStatus, JunctionEvent, PlanStep
from kurt2rt.core.decision.goal import NamedGoal, PartialGoal, RlaGoal
from kurt2rt.core.expectations.expectations import Surprise
from kurt2rt.core.rla.credit import Credit
from kurt2rt.core.rla.events import LessonUndone, RlaCreated, RlaRewarded
from kurt2rt.core.rla.rla import Origin, Phase, Rla
from kurt2rt.core.teaching.commands import Command, Seek
from kurt2rt.core.teaching.inbox import SystemEvent
from kurt2rt.runs.recording.entries import DecisionEntry, MatchEntry, MidEntry, OpinionEntry, ResultEntry, TickEntry
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.recording.tick_json import _decoder, decode_command, decode_tick, encode_command, encode_tick

KINDS = (*get_args(Command), *get_args(SystemEvent))

number = some.floats(allow_nan=False)
text = some.text(some.characters(codec="utf-8"), max_size=8)
maybe_id = some.none() | some.integers(1, 2**40)
wheels = some.builds(WheelSpeeds, number, number)
readings = some.builds(
    SensorReadings,
    number,
    some.lists(some.integers(0, 1023), max_size=18).map(tuple),
    number,
    some.integers(),
    some.integers(),
    number,
    some.integers(0, 255),
    number,
)
grants = some.builds(
    GuardResult, wheels, some.lists(some.sampled_from(GuardReason), max_size=2).map(tuple), some.booleans()
)
or_absent = some.sampled_from((True, None))
matches = some.builds(
    MatchEntry, some.integers(1), number, number, some.booleans(), maybe_id, number, or_absent, or_absent
)
junctions = some.builds(JunctionEvent, some.integers(-1, 2), some.booleans(), some.booleans(), number, number)
mids = some.builds(
    MidEntry, text, maybe_id, some.none() | matches, some.booleans(), some.booleans(), some.none() | junctions
)
plans = some.builds(
    PlanStep, text, some.sampled_from(GoalStatus), some.lists(text).map(tuple), maybe_id, text, some.integers(0)
)
decisions = some.builds(
    DecisionEntry,
    wheels,
    some.sampled_from(DecisionCause),
    some.none() | text,
    maybe_id,
    some.none() | matches,
    some.booleans(),
    some.sampled_from(("basic", "mid")),
    some.none() | mids,
    some.none() | plans,
    some.sampled_from((None, float("inf"))) | number,
    or_absent,
)
opinions = some.builds(OpinionEntry, some.integers(-1, 1), text, number, maybe_id, number, number, some.booleans())
surprises = some.builds(
    Surprise,
    text,
    some.integers(1),
    some.integers(1),
    number,
    number,
    some.integers(0),
    some.integers(0),
    some.booleans(),
)
# Half a surrogate pair cannot stand in a journal, so no teacher's command has one.
commands = some.sampled_from(KINDS).flatmap(some.from_type).filter(lambda command: "nan" not in repr(command))
origins = some.builds(Origin, text, text, some.sampled_from(Phase), some.integers(0, 2**40))
finite = some.floats(allow_nan=False, allow_infinity=False)
rlas = some.builds(
    Rla,
    some.integers(1, 2**40),
    some.lists(finite, max_size=4).map(tuple),
    text,
    some.none() | finite,
    origins,
    text,
    text,
)
credits_ = some.lists(some.builds(Credit, some.integers(1, 99), finite), max_size=3).map(tuple)
events = (
    some.builds(RlaCreated, rlas)
    | some.builds(LessonUndone, text, origins)
    | some.builds(
        RlaRewarded,
        some.integers(1),
        some.sampled_from((1, -1)),
        some.integers(0, 2**40),
        origins,
        credits_,
        some.none(),
    )
)
entries = some.builds(
    TickEntry,
    some.integers(1),
    some.integers(0),
    number,
    readings,
    grants,
    some.lists(commands, max_size=3).map(tuple),
    some.none() | text,
    some.booleans(),
    decisions,
    text,
    some.none() | opinions,
    some.none() | surprises,
    some.lists(some.builds(ResultEntry, text, some.booleans(), text, some.booleans(), text), max_size=2).map(tuple),
    some.lists(events, max_size=2).map(tuple),
    some.integers(0, 2**32 - 1),
    some.none() | text,
    lesson_speed=some.none() | some.floats(0.2, 1.0, exclude_max=True),
)


@given(entries)
def test_a_tick_comes_back_as_it_was(entry: TickEntry) -> None:
    again = decode_tick(encode_tick(entry))
    assert again == entry
    assert repr(again) == repr(entry)  # 0.0 is equal to -0.0, and 1 to 1.0


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
