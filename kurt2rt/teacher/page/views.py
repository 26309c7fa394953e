"""What pages are told, as plain values for JSON."""

import math
from collections.abc import Mapping
from dataclasses import asdict, is_dataclass
from typing import Any

from hal.guard_reason import GuardReason
from kurt2rt.channel.protocol.exam_status import EXAM, ExamStatus
from kurt2rt.channel.protocol.health import HealthReport
from kurt2rt.channel.protocol.health_text import headline, name_of, rows_of, trouble_in
from kurt2rt.channel.protocol.hello import Hello
from kurt2rt.channel.protocol.lesson_list import LessonLine
from kurt2rt.channel.protocol.simulation import SIMULATION, SimulationView
from kurt2rt.channel.protocol.state import State
from kurt2rt.channel.protocol.world import WorldView
from kurt2rt.core.decision.standing_text import GO_ON_PAGE, standing_headline
from kurt2rt.core.outcome_text import Surface
from kurt2rt.core.perception.sensor_words import NO_WORDS, SensorWords
from kurt2rt.core.teaching.question import FeatureDifference
from kurt2rt.teacher.client.answer import Answer
from kurt2rt.teacher.client.link_quality import LinkQuality

_EACH_CHANGE_OF_SPEED = (GuardReason.SLEW_LIMIT, GuardReason.SPEED_LIMIT)
"""Limits that every change of speed meets; the page leaves them out."""


def state_view(
    state: State, link: LinkQuality, age_s: float, refused: str, words: SensorWords = NO_WORDS
) -> dict[str, Any]:
    """Return one picture of the robot.

    `age_s` is how long ago it came here, `refused` why hold-to-drive does nothing; `words` are for its sensors.
    """
    place, stands = state.place, state.stands
    return {
        "kind": "state",
        "tick": state.tick,
        "phase": state.phase,
        "infrared": state.infrared_counts,
        "infrared_age_s": _finite(state.infrared_age_s),
        "bumpers": state.bumpers,
        "left_m_s": state.left_m_s,
        "right_m_s": state.right_m_s,
        "cause": state.cause,
        "stands": {
            "reason": stands.reason,
            "needs_go": stands.needs_resume,
            "asks": stands.asks,
            "text": standing_headline(stands, GO_ON_PAGE),
        },
        "action": state.action,
        "rla": state.rla,
        "nearest": state.nearest,
        "nearest_action": state.nearest_action,
        "distance": _finite(state.distance),
        "radius": _finite(state.radius),
        "taught_by": state.taught_by,
        "taught_at": state.taught_at,
        "question": [_difference(each, words) for each in state.question],
        "teacher": state.teacher,
        "by_hand": state.by_hand,
        "stopped": None if state.stopped is None else state.stopped.reason,
        "rlas": state.rlas,
        "lessons": state.lessons,
        "unsaved": state.unsaved,
        "session": state.session,
        "clock_s": state.clock_s,
        "guard": [reason for reason in state.guard if reason not in _EACH_CHANGE_OF_SPEED],
        "trouble": state.trouble,
        "late_p99_ms": _finite(state.late_p99_ms),
        "missed_ticks": state.missed_ticks,
        "behaviour": state.behaviour,
        "value": state.value,
        "nearest_value": state.nearest_value,
        "opinion": state.opinion,
        "opinion_of": state.opinion_of,
        "agreement": state.agreement,
        "trusted": state.trusted,
        "role": state.role,
        "bad_share": state.bad_share,
        "signals_missing": state.signals_missing,
        "asks_at": state.asks_at,
        "mid": plain(state.mid),
        "surprise": plain(state.surprise),
        "goal": state.goal,
        "plan": state.plan,
        "plan_says": state.plan_says,
        "place": None if place is None else asdict(place),
        "progress": asdict(state.progress),
        "link": {
            "age_ms": round(age_s * 1000),
            "rtt_ms": None if link.rtt_ms is None else _finite(link.rtt_ms),
            "pictures_per_s": _finite(link.states_per_s),
        },
        "refused": refused,
    }


def _difference(each: FeatureDifference, words: SensorWords) -> list[Any]:
    """Return name, value here and as taught, and the same three in words."""
    name, here, there = each.name, each.here, each.in_condition
    return [name, here, there, words.place(name), words.reading(name, here), words.reading(name, there)]


def answer_view(number: int, answer: Answer) -> dict[str, Any]:
    """What became of an order."""
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
    """An order that never reached the robot, or of which it is not known whether it did."""
    return {"kind": "answer", "number": number, "accepted": False, "why": why, "text": text, "tick": -1, "extra": {}}


def hello_view(hello: Hello) -> dict[str, Any]:
    """What robot this is."""
    return {"kind": "hello", **plain(hello)}


def world_view(world: WorldView) -> dict[str, Any]:
    """The simulated world."""
    return {"kind": "world", **plain(world)}


def lessons_view(lessons: tuple[LessonLine, ...]) -> dict[str, Any]:
    """The newest lessons."""
    return {"kind": "lessons", "lessons": [each._asdict() for each in lessons]}


def situations_view(names: tuple[str, ...]) -> dict[str, Any]:
    """The situations that have a name."""
    return {"kind": "situations", "situations": names}


def health_view(report: HealthReport | None) -> dict[str, Any]:
    """How the robot's program is, in words: nothing in its first second."""
    if report is None:
        return {"kind": "health", "tick": None, "says": "", "rows": [], "troubles": []}
    troubles = [
        {"name": name_of(each), "what": each.what, "text": trouble_in(each), "urgent": each.urgent}
        for each in report.troubles
    ]
    return {
        "kind": "health",
        "tick": report.tick,
        "says": headline(report),
        "rows": [each._asdict() for each in rows_of(report)],
        "troubles": troubles,
    }


def exam_view(standing: ExamStatus) -> dict[str, Any]:
    """Return the exam's status for the page."""
    return {"kind": "exam", **EXAM.plain_of(standing)}


def simulation_view(simulation: SimulationView) -> dict[str, Any]:
    """Return the simulated world and task, and those to choose from, for the page."""
    return {"kind": "simulation", **SIMULATION.plain_of(simulation)}


def plain(value: Any) -> Any:
    """Dataclasses, tuples and bytes as JSON knows them; no infinite numbers."""
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
