"""JSON schemas of the project's own topics, for plots in Foxglove."""

from typing import Any

JsonSchema = dict[str, Any]

_NUMBER: JsonSchema = {"type": "number"}
_COUNT: JsonSchema = {"type": "integer"}
_TEXT: JsonSchema = {"type": "string"}
_FLAG: JsonSchema = {"type": "boolean"}


def _map(**properties: JsonSchema) -> JsonSchema:
    return {"type": "object", "properties": properties}


def _many(items: JsonSchema) -> JsonSchema:
    return {"type": "array", "items": items}


_WHEELS = _map(left_m_s=_NUMBER, right_m_s=_NUMBER)
_MATCH = _map(
    rla_id=_COUNT, distance=_NUMBER, radius=_NUMBER, known=_FLAG, runner_up=_COUNT, runner_up_distance=_NUMBER
)
_EVENT = _map(kind=_TEXT, rla_id=_COUNT, action=_TEXT, command_id=_TEXT, teacher=_TEXT, phase=_COUNT, tick=_COUNT)

TICK_SCHEMA: JsonSchema = {
    "title": "kurt2rt.Tick",
    **_map(
        tick=_COUNT,
        now_s=_NUMBER,
        readings=_map(
            time_s=_NUMBER,
            infrared_counts=_many(_COUNT),
            infrared_age_s=_NUMBER,
            encoder_left_ticks=_COUNT,
            encoder_right_ticks=_COUNT,
            encoder_age_s=_NUMBER,
            bumpers=_COUNT,
            bumper_age_s=_NUMBER,
        ),
        grant=_map(wheels=_WHEELS, reasons=_many(_TEXT), latched=_FLAG),
        commands=_many({"type": "object"}),
        saving_error=_TEXT,
        saved=_FLAG,
        lesson_speed=_NUMBER,
        decision=_map(
            wheels=_WHEELS,
            cause=_TEXT,
            action=_TEXT,
            rla_id=_COUNT,
            match=_MATCH,
            answers=_FLAG,
            asks_at=_TEXT,
            mid=_map(behaviour=_TEXT, rla_id=_COUNT, match=_MATCH, asks=_FLAG, overridden=_FLAG),
        ),
        behaviour=_TEXT,
        opinion=_map(value=_COUNT, appraisal=_TEXT, distance=_NUMBER),
        results=_many(_map(command_id=_TEXT, accepted=_FLAG, text=_TEXT, lesson=_FLAG, code=_TEXT)),
        events=_many(_EVENT),
        situation_crc32=_COUNT,
        knowledge=_TEXT,
    ),
}
"""Schema of every tick; kurt2rt.runs.recording.entries reads it."""

LESSON_SCHEMA: JsonSchema = {
    "title": "kurt2rt.Lesson",
    **_map(event=_EVENT, acknowledged=_TEXT, sequence=_COUNT, error=_TEXT, stamped_at=_TEXT),
}
"""Schema of a teaching event in journal form, or of its acknowledgement."""

HEALTH_SCHEMA: JsonSchema = {"title": "kurt2rt.Health", "type": "object"}
"""Schema of the health report, once a second: kurt2rt.channel.protocol.health."""


def situation_schema(features: tuple[str, ...]) -> JsonSchema:
    """Return the schema of a situation: one number per feature."""
    return {"title": "kurt2rt.Situation", "type": "object", "properties": dict.fromkeys(features, _NUMBER)}
