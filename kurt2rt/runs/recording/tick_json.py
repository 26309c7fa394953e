"""JSON codec of tick entries, exact to the last bit of every float64."""

import json
import math
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, TypeVar, get_args, get_type_hints

from pydantic import TypeAdapter, ValidationError

from hal.guard_reason import GuardReason
from hal.robot import GuardResult, SensorReadings, WheelSpeeds
from kurt2rt.core.decision.decision import DecisionCause, GoalStatus, JunctionEvent, PlanStep
from kurt2rt.core.expectations.surprise import Surprise
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.core.teaching.commands import Command
from kurt2rt.core.teaching.inbox import Input, SystemEvent
from kurt2rt.knowledge.journal.event_codec import decode_event, encode_event
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.runs.recording.entries import DecisionEntry, MatchEntry, MidEntry, OpinionEntry, ResultEntry, TickEntry
from kurt2rt.runs.recording.recording_error import RecordingError

_Value = TypeVar("_Value")
_ADAPTERS: dict[str, TypeAdapter[Any]] = {
    kind.__name__: TypeAdapter(kind) for kind in (*get_args(Command), *get_args(SystemEvent))
}


def encode_tick(entry: TickEntry) -> bytes:
    """Return the entry as UTF-8 JSON without absent fields; infinity and NaN become texts.

    Raises RecordingError for an event that cannot be written.
    """
    try:
        return json.dumps(_content(entry), allow_nan=False, separators=(",", ":")).encode()
    except (KnowledgeError, ValueError, TypeError) as error:
        raise RecordingError(f"tick {entry.tick} cannot be written: {error}") from error


def decode_tick(data: bytes) -> TickEntry:
    """Return the entry of `encode_tick`, equal to the last bit. Raises RecordingError."""
    try:
        return _entry(json.loads(data))
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError, KnowledgeError) as error:
        raise RecordingError(f"not a tick of a run: {type(error).__name__}: {error}") from error


def _number(value: float) -> float | str:
    return float(value) if math.isfinite(value) else repr(float(value))


def _present(content: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in content.items() if value is not None}


def _content(entry: TickEntry) -> dict[str, Any]:
    readings, grant = entry.readings, entry.grant
    return _present(
        {
            "number": entry.number,
            "tick": entry.tick,
            "now_s": _number(entry.now_s),
            "readings": {
                **({} if readings.time_s == entry.now_s else {"time_s": _number(readings.time_s)}),
                "infrared_counts": readings.infrared_counts,
                "infrared_age_s": _number(readings.infrared_age_s),
                "encoder_left_ticks": readings.encoder_left_ticks,
                "encoder_right_ticks": readings.encoder_right_ticks,
                "encoder_age_s": _number(readings.encoder_age_s),
                "bumpers": readings.bumpers,
                "bumper_age_s": _number(readings.bumper_age_s),
            },
            "grant": {"wheels": _wheels(grant.wheel_speeds), "reasons": grant.reasons, "latched": grant.latched},
            "commands": [encode_command(each) for each in entry.commands] or None,
            "saving_error": entry.saving_error,
            "saved": entry.saved or None,
            "lesson_speed": entry.lesson_speed,
            "decision": _decision(entry.decision),
            "behaviour": entry.behaviour,
            "opinion": None if entry.opinion is None else _tuple(entry.opinion),
            "surprise": None if entry.surprise is None else _tuple(entry.surprise),
            "results": [_tuple(each) for each in entry.results] or None,
            "events": [json.loads(encode_event(each)) for each in entry.events] or None,
            "situation_crc32": entry.situation_crc32,
            "knowledge": entry.knowledge,
        }
    )


def _wheels(speeds: WheelSpeeds) -> dict[str, Any]:
    return {"left_m_s": _number(speeds.left_m_s), "right_m_s": _number(speeds.right_m_s)}


def _tuple(value: Any) -> dict[str, Any]:
    """Return a named tuple as a mapping; floats that are not finite become texts."""
    fields: dict[str, Any] = value._asdict()
    return _present({key: _number(each) if isinstance(each, float) else each for key, each in fields.items()})


def _decision(decision: DecisionEntry) -> dict[str, Any]:
    mid = decision.mid
    return _present(
        {
            "wheels": _wheels(decision.wheel_speeds),
            "cause": decision.cause.value,
            "action": decision.action,
            "rla_id": decision.rla_id,
            "match": None if decision.match is None else _tuple(decision.match),
            "answers": decision.answers,
            "asks_at": None if decision.asks_at == BASIC else decision.asks_at,
            "mid": None
            if mid is None
            else _present(
                {
                    **_tuple(mid),
                    "match": None if mid.match is None else _tuple(mid.match),
                    "event": None if mid.event is None else _tuple(mid.event),
                }
            ),
            "plan": None if decision.plan is None else _tuple(decision.plan),
            "doubt": None if decision.doubt is None else _number(decision.doubt),
        }
    )


def _entry(content: dict[str, Any]) -> TickEntry:
    readings, grant = content["readings"], content["grant"]
    opinion, surprise = content.get("opinion"), content.get("surprise")
    return _decoded(
        TickEntry,
        content,
        readings=_decoded(
            SensorReadings,
            readings,
            time_s=float(readings.get("time_s", content["now_s"])),
            infrared_counts=tuple(readings["infrared_counts"]),
        ),
        grant=GuardResult(
            _decoded(WheelSpeeds, grant["wheels"]), tuple(map(GuardReason, grant["reasons"])), grant["latched"]
        ),
        commands=tuple(decode_command(each) for each in content.get("commands", ())),
        saved=content.get("saved", False),
        decision=_decision_of(content["decision"]),
        opinion=None if opinion is None else _decoded(OpinionEntry, opinion),
        surprise=None if surprise is None else _decoded(Surprise, surprise),
        results=tuple(ResultEntry(**each) for each in content.get("results", ())),
        events=tuple(decode_event(json.dumps(each), f"tick {content['tick']}") for each in content.get("events", ())),
    )


def _decision_of(decision: dict[str, Any]) -> DecisionEntry:
    mid, plan = decision.get("mid"), decision.get("plan")
    return _decoded(
        DecisionEntry,
        decision,
        wheel_speeds=_decoded(WheelSpeeds, decision["wheels"]),
        cause=DecisionCause(decision["cause"]),
        match=_match_of(decision.get("match")),
        asks_at=decision.get("asks_at", BASIC),
        mid=None if mid is None else _mid_of(mid),
        plan=None if plan is None else _plan_of(plan),
    )


def _match_of(match: dict[str, Any] | None) -> MatchEntry | None:
    return None if match is None else _decoded(MatchEntry, match)


def _mid_of(mid: dict[str, Any]) -> MidEntry:
    event = mid.get("event")
    return _decoded(
        MidEntry,
        mid,
        match=_match_of(mid.get("match")),
        event=None if event is None else _decoded(JunctionEvent, event),
    )


def _plan_of(plan: dict[str, Any]) -> PlanStep:
    return _decoded(PlanStep, plan, course=GoalStatus(plan["course"]), behaviours=tuple(plan["behaviours"]))


def _decoded(kind: Callable[..., _Value], content: Mapping[str, Any], **decoded: Any) -> _Value:
    """Return the named tuple of a JSON object; `decoded`: values of fields that are no plain numbers or texts.

    Raises KeyError for an absent field, unless it may be None.
    """
    fields = dict(decoded)
    for name, is_float, is_optional in _fields_of(kind):
        if name not in fields:
            value: Any = content.get(name) if is_optional else content[name]
            fields[name] = float(value) if is_float and value is not None else value
    return kind(**fields)


@cache
def _fields_of(kind: type) -> tuple[tuple[str, bool, bool], ...]:
    """Return the name of each field of a named tuple, whether it is a float, and whether it may be None."""
    hints = get_type_hints(kind)
    return tuple((name, float in (hint, *get_args(hint)), type(None) in get_args(hint)) for name, hint in hints.items())


def encode_command(command: Input) -> dict[str, Any]:
    """Return a JSON object: the name of the class as `is`, then the fields."""
    name = type(command).__name__
    return {"is": name, **_finite(_ADAPTERS[name].dump_python(command, mode="json"))}


def decode_command(content: object) -> Input:
    """Return the command that `encode_command` wrote, equal to the last bit. Raises RecordingError."""
    if not isinstance(content, dict):
        raise RecordingError(f"a {type(content).__name__} is no command")
    fields = dict(content)
    name = fields.pop("is", None)
    adapter = _ADAPTERS.get(name) if isinstance(name, str) else None
    if adapter is None:
        raise RecordingError(f"there is no command {name!r}")
    try:
        command: Input = adapter.validate_python(fields, strict=False)
    except ValidationError as error:
        problem = error.errors(include_url=False)[0]
        place = ".".join(map(str, problem["loc"]))
        raise RecordingError(f"{place}: {problem['msg']}", where=name) from error
    return command


def _finite(value: Any) -> Any:
    """JSON knows no infinity: it is a text there."""
    match value:
        case float():
            return value if math.isfinite(value) else repr(value)
        case dict():
            return {key: _finite(each) for key, each in value.items()}
        case list():
            return [_finite(each) for each in value]
    return value
