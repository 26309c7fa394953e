"""Messages to the pages, as plain values for JSON."""

import math
from collections.abc import Mapping
from dataclasses import asdict, is_dataclass
from typing import Any

from hal.guard_reason import GuardReason
from kurt2rt.channel.protocol.health import HealthReport
from kurt2rt.channel.protocol.health_text import headline, name_of, rows_of, rules_in, trouble_in
from kurt2rt.channel.protocol.hello import Hello
from kurt2rt.channel.protocol.lesson_list import LessonLine
from kurt2rt.channel.protocol.simulation import EXAM, SIMULATION, ExamStatus, SimulationView, WorldView
from kurt2rt.channel.protocol.state import HoldState, MidState, ShownState, State, SurpriseState
from kurt2rt.core.decision.standing import GO_ON_PAGE, StopReason, standing_headline
from kurt2rt.core.outcome_text import Surface
from kurt2rt.core.perception.sensor_words import NO_WORDS, SensorWords
from kurt2rt.core.teaching.question import FeatureDifference
from kurt2rt.runs.explain.attribution import distance_attribution
from kurt2rt.runs.explain.facts import DecisionFacts, LevelFacts, RlaFacts
from kurt2rt.runs.explain.reasons import format_reasons
from kurt2rt.runs.explain.reasons import headline as decision_headline
from kurt2rt.runs.explain.sentences import (
    format_mid_level,
    format_runner_up,
    format_teaching,
    format_usage,
)
from kurt2rt.teacher.client.answer import Answer
from kurt2rt.teacher.client.link_quality import LinkQuality
from kurt2rt.teacher.page.texts import PageNotice, text_of
from simbridge.contracts.simulation import SimulatedPlace

_FEATURES = 6


def why_view(number: int, facts: DecisionFacts | None, words: SensorWords = NO_WORDS) -> dict[str, Any]:
    """Return the answer to question `number`; `facts` are None before the first tick."""
    view = {"kind": "answer", "number": number, "accepted": True, "text": text_of(PageNotice.NOTHING_DECIDED)}
    if facts is None:
        return {**view, "lines": [], "features": []}
    level, rla = facts.deciding
    lines = format_reasons(facts)
    if rla is not None:
        lines += [*format_runner_up(level), format_teaching(rla), format_usage(rla)]
    return {
        **view,
        "text": decision_headline(facts),
        "tick": facts.tick,
        "lines": [*lines, *format_mid_level(facts)],
        "rla": "" if rla is None else rla.title,
        "features": [] if rla is None else _features(level, rla, words),
        "taught": None if rla is None else {"rla": rla.rla_id, "counts": _readings(level, rla, words)},
    }


def _readings(level: LevelFacts, rla: RlaFacts, words: SensorWords) -> dict[str, float]:
    """Return the readings in an RLA's condition, in counts by the sensor's name."""
    return {name: value for name, value in zip(level.names, rla.condition, strict=True) if words.is_reading(name)}


def _features(level: LevelFacts, rla: RlaFacts, words: SensorWords) -> list[dict[str, Any]]:
    return [
        {
            "name": words.place(each.name),
            "here": words.reading(each.name, each.here),
            "there": words.reading(each.name, each.there),
            "share": round(each.share, 3),
        }
        for each in distance_attribution(level, rla)[:_FEATURES]
    ]


_SPEED_CHANGES = (GuardReason.SLEW_LIMIT, GuardReason.SPEED_LIMIT)
"""Limits that every change of speed meets; the page leaves them out."""
_COPIED = (
    *("tick", "phase", "bumpers", "left_m_s", "right_m_s", "cause", "action", "rla", "nearest", "nearest_action"),
    *("taught_at", "teacher", "by_hand", "lessons", "unsaved", "session", "clock_s", "trouble", "behaviour", "value"),
    *("image", "nearest_image", "nearest_value", "opinion", "opinion_of", "agreement", "trusted", "role", "bad_share"),
    *("signals_missing", "asks_at", "goal", "plan", "plan_says", "lesson_speed", "speed_share"),
)
"""Fields of State that the page gets as they are."""
_FINITE = ("distance", "radius")
"""Fields of State that may be infinite, which the page gets as null."""


_YOUR_STOPS = (StopReason.SAID_STOP, StopReason.LET_GO, StopReason.LINK_LOST)
"""Stops that are told as those of `you` to the device that caused them."""


def state_view(
    state: State, link: LinkQuality, age_s: float, refused: str, words: SensorWords = NO_WORDS, device: str = ""
) -> dict[str, Any]:
    """Return the message for one state.

    Args:
        state: of the robot.
        link: quality of the link to the robot.
        age_s: time since the state came.
        refused: reason why the last press does not drive, if any.
        words: for the robot's sensors.
        device: name of the page's device, which is `you` in the texts.
    """
    stands, stop = state.standing, state.standing.stop
    if stop is not None and stop.reason in _YOUR_STOPS and stop.name == device:
        stands = stands._replace(stop=stop._replace(name="you"))
    return {
        "kind": "state",
        **{name: getattr(state, name) for name in _COPIED},
        **{name: _finite(getattr(state, name)) for name in _FINITE},
        "infrared": state.infrared_counts,
        "taught_by": "you" if state.taught_by == device else state.taught_by,
        "yours": state.teacher == device,
        "stands": {
            "reason": stands.reason,
            "needs_go": stands.needs_resume,
            "asks": stands.asks,
            "text": standing_headline(stands, GO_ON_PAGE),
        },
        "question": [_difference(each, words) for each in state.question],
        "stopped": None if state.stopped is None else state.stopped.reason,
        "guard": [reason for reason in state.guard if reason not in _SPEED_CHANGES],
        "mid": _row_view(state.mid),
        "surprise": _row_view(state.surprise),
        "shown": _row_view(state.shown),
        "hold": _row_view(state.hold),
        "place": _row_view(state.place),
        "progress": asdict(state.progress),
        "link": {
            "age_ms": round(age_s * 1000),
            "rtt_ms": None if link.rtt_ms is None else _finite(link.rtt_ms),
            "pictures_per_s": _finite(link.states_per_s),
        },
        "refused": refused,
    }


def _row_view(row: MidState | SurpriseState | ShownState | HoldState | SimulatedPlace | None) -> Any:
    return None if row is None else plain(row._asdict())


def _difference(each: FeatureDifference, words: SensorWords) -> list[Any]:
    """Return [name, value here, value as taught], and the same three in words."""
    name, here, there = each.name, each.here, each.in_condition
    return [name, here, there, words.place(name), words.reading(name, here), words.reading(name, there)]


def answer_view(number: int, answer: Answer) -> dict[str, Any]:
    """Return the message for the robot's answer to the page's command `number`."""
    return {
        "kind": "answer",
        "number": number,
        "accepted": answer.accepted,
        "why": answer.why,
        "text": answer.text_on(Surface.PAGE),
        "tick": answer.tick,
        "extra": plain(answer.extra),
    }


def refusal_view(number: int, why: str, text: str) -> dict[str, Any]:
    """Return the message for the page's command `number` that was not sent, or that the robot did not answer.

    `why`: word for the reason. `text`: sentence for the teacher.
    """
    return {"kind": "answer", "number": number, "accepted": False, "why": why, "text": text, "tick": -1, "extra": {}}


def hello_view(hello: Hello) -> dict[str, Any]:
    """Return the message with the robot's introduction."""
    return {"kind": "hello", **plain(hello)}


def world_view(world: WorldView) -> dict[str, Any]:
    """Return the message with the simulated world from above."""
    return {"kind": "world", **plain(world)}


def lessons_view(lessons: tuple[LessonLine, ...]) -> dict[str, Any]:
    """Return the message with the newest lessons, newest first."""
    rows = ({**each._asdict(), "against": [other._asdict() for other in each.against]} for each in lessons)
    return {"kind": "lessons", "lessons": list(rows)}


def situations_view(names: tuple[str, ...]) -> dict[str, Any]:
    """Return the message with the names of situations."""
    return {"kind": "situations", "situations": names}


def health_view(report: HealthReport | None) -> dict[str, Any]:
    """Return the message with the health report in words; empty in the robot's first second."""
    if report is None:
        return {"kind": "health", "tick": None, "says": "", "rules": "", "rows": [], "troubles": []}
    troubles = [
        {"name": name_of(each), "what": each.what, "text": trouble_in(each), "urgent": each.urgent}
        for each in report.troubles
    ]
    return {
        "kind": "health",
        "tick": report.tick,
        "says": headline(report),
        "rules": rules_in(report),
        "rows": [each._asdict() for each in rows_of(report)],
        "troubles": troubles,
    }


def exam_view(status: ExamStatus) -> dict[str, Any]:
    """Return the message with the exam's status."""
    return {"kind": "exam", **EXAM.plain_of(status)}


def simulation_view(simulation: SimulationView) -> dict[str, Any]:
    """Return the message with the simulated world and task, and those to choose from."""
    return {"kind": "simulation", **SIMULATION.plain_of(simulation)}


def plain(value: Any) -> Any:
    """Return a value as JSON has it: dataclasses as objects, bytes in hexadecimal, infinite numbers as null."""
    if is_dataclass(value) and not isinstance(value, type):
        return plain(asdict(value))
    if isinstance(value, Mapping):
        return {str(key): plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [plain(each) for each in value]
    if isinstance(value, bytes):
        return value.hex()
    if isinstance(value, float):
        return _finite(value)
    return value


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
