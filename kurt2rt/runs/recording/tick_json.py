"""A tick's entry as JSON, exact to the last bit of every float64, and back."""

import json
import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any, TypeVar

from hal.guard_reason import guard_reason
from hal.robot import GuardResult, SensorReadings, WheelSpeeds
from kurt2rt.core.decision.decision import Cause
from kurt2rt.core.decision.junction_event import JunctionEvent
from kurt2rt.core.decision.plan_step import GoalStatus, PlanStep
from kurt2rt.core.expectations.surprise import Surprise
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.knowledge.journal.event_codec import decode_event, encode_event
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.runs.recording.command_json import decode_command, encode_command
from kurt2rt.runs.recording.entries import DecisionEntry, MatchEntry, MidEntry, OpinionEntry, ResultEntry, TickEntry
from kurt2rt.runs.recording.recording_error import RecordingError

_Value = TypeVar("_Value")


def encode_tick(entry: TickEntry) -> bytes:
    """JSON of an entry, in UTF-8; what is not there is left out, infinity and NaN are texts.

    Raises RecordingError for an event that cannot be written.
    """
    try:
        return json.dumps(_content(entry), allow_nan=False, separators=(",", ":")).encode()
    except (KnowledgeError, ValueError, TypeError) as error:
        raise RecordingError(f"tick {entry.tick} cannot be written: {error}") from error


def decode_tick(data: bytes) -> TickEntry:
    """The entry that `encode_tick` wrote, equal to the last bit. Raises RecordingError."""
    try:
        return _entry(json.loads(data))
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError, KnowledgeError) as error:
        raise RecordingError(f"not a tick of a run: {type(error).__name__}: {error}") from error


def _number(value: float) -> float | str:
    return float(value) if math.isfinite(value) else repr(float(value))


def _present(content: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in content.items() if value is not None}


def _content(entry: TickEntry) -> dict[str, Any]:
    senses, grant = entry.senses, entry.grant
    return _present(
        {
            "number": entry.number,
            "tick": entry.tick,
            "now_s": _number(entry.now_s),
            "senses": {
                **({} if senses.time_s == entry.now_s else {"time_s": _number(senses.time_s)}),
                "infrared_counts": senses.infrared_counts,
                "infrared_age_s": _number(senses.infrared_age_s),
                "encoder_left_ticks": senses.encoder_left_ticks,
                "encoder_right_ticks": senses.encoder_right_ticks,
                "encoder_age_s": _number(senses.encoder_age_s),
                "bumpers": senses.bumpers,
                "bumper_age_s": _number(senses.bumper_age_s),
            },
            "grant": {"wheels": _wheels(grant.wheel_speeds), "reasons": grant.reasons, "latched": grant.latched},
            "commands": [encode_command(each) for each in entry.commands] or None,
            "trouble": entry.trouble,
            "saved": entry.saved or None,
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
    """A named tuple of plain values; floats that are not finite are texts."""
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
        }
    )


def _entry(content: dict[str, Any]) -> TickEntry:
    senses, grant = content["senses"], content["grant"]
    opinion, surprise = content.get("opinion"), content.get("surprise")
    return TickEntry(
        content["number"],
        content["tick"],
        float(content["now_s"]),
        SensorReadings(
            float(senses.get("time_s", content["now_s"])),
            tuple(senses["infrared_counts"]),
            float(senses["infrared_age_s"]),
            senses["encoder_left_ticks"],
            senses["encoder_right_ticks"],
            float(senses["encoder_age_s"]),
            senses["bumpers"],
            float(senses["bumper_age_s"]),
        ),
        GuardResult(_speeds_of(grant["wheels"]), tuple(map(guard_reason, grant["reasons"])), grant["latched"]),
        _all(decode_command, content.get("commands", ())),
        content.get("trouble"),
        content.get("saved", False),
        _decision_of(content["decision"]),
        content["behaviour"],
        None
        if opinion is None
        else OpinionEntry(
            opinion["value"],
            opinion["appraisal"],
            float(opinion["trace_s"]),
            opinion.get("rla_id"),
            float(opinion["distance"]),
            float(opinion["radius"]),
            opinion["known"],
        ),
        None if surprise is None else _surprise_of(surprise),
        tuple(ResultEntry(**each) for each in content.get("results", ())),
        _all(lambda each: decode_event(json.dumps(each), f"tick {content['tick']}"), content.get("events", ())),
        content["situation_crc32"],
        content.get("knowledge"),
    )


def _all(decode: Callable[[Any], _Value], items: Iterable[Any]) -> tuple[_Value, ...]:
    return tuple(decode(each) for each in items)


def _speeds_of(wheels: dict[str, Any]) -> WheelSpeeds:
    return WheelSpeeds(float(wheels["left_m_s"]), float(wheels["right_m_s"]))


def _surprise_of(surprise: dict[str, Any]) -> Surprise:
    return Surprise(
        surprise["level"],
        surprise["rla_id"],
        surprise["follow_up"],
        float(surprise["distance"]),
        float(surprise["usual"]),
        surprise["ends"],
        surprise["seen"],
        surprise["surprising"],
    )


def _match_of(match: dict[str, Any] | None) -> MatchEntry | None:
    if match is None:
        return None
    return MatchEntry(
        match["rla_id"],
        float(match["distance"]),
        float(match["radius"]),
        match["known"],
        match.get("runner_up"),
        float(match["runner_up_distance"]),
    )


def _decision_of(decision: dict[str, Any]) -> DecisionEntry:
    mid, plan = decision.get("mid"), decision.get("plan")
    return DecisionEntry(
        _speeds_of(decision["wheels"]),
        Cause(decision["cause"]),
        decision.get("action"),
        decision.get("rla_id"),
        _match_of(decision.get("match")),
        decision["answers"],
        decision.get("asks_at", BASIC),
        None if mid is None else _mid_of(mid),
        None if plan is None else _plan_of(plan),
    )


def _mid_of(mid: dict[str, Any]) -> MidEntry:
    event = mid.get("event")
    return MidEntry(
        mid["behaviour"],
        mid.get("rla_id"),
        _match_of(mid.get("match")),
        mid["asks"],
        mid["overridden"],
        None
        if event is None
        else JunctionEvent(
            event["quarters"],
            event["left_open"],
            event["right_open"],
            float(event["turn_rad"]),
            float(event["way_m"]),
        ),
    )


def _plan_of(plan: dict[str, Any]) -> PlanStep:
    return PlanStep(
        plan["goal"],
        GoalStatus(plan["course"]),
        tuple(plan["behaviours"]),
        plan.get("rla_id"),
        plan["says"],
        plan["surprises"],
    )
