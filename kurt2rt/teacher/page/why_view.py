"""Explanation of a decision, as a message for a page."""

from typing import Any

from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.perception.sensor_words import NO_WORDS, SensorWords
from kurt2rt.core.rla.rla import MID
from kurt2rt.runs.explain.attribution import distance_attribution
from kurt2rt.runs.explain.facts import DecisionFacts, LevelFacts, RlaFacts
from kurt2rt.runs.explain.reasons import format_reasons, headline
from kurt2rt.runs.explain.sentences import (
    format_guard,
    format_mid_level,
    format_runner_up,
    format_teaching,
    format_usage,
)
from kurt2rt.teacher.page.texts import PageNotice, text_of

_FEATURES = 6


def why_view(number: int, facts: DecisionFacts | None, words: SensorWords = NO_WORDS) -> dict[str, Any]:
    """Return the answer to question `number`; `facts` are None before the first tick."""
    view = {"kind": "answer", "number": number, "accepted": True, "text": text_of(PageNotice.NOTHING_DECIDED)}
    if facts is None:
        return {**view, "lines": [], "features": []}
    level, rla = _leading(facts)
    lines = [*format_reasons(facts), format_guard(facts)]
    if rla is not None:
        lines += [*format_runner_up(level), format_teaching(rla), format_usage(rla)]
    return {
        **view,
        "text": headline(facts),
        "tick": facts.tick,
        "lines": [line for line in (*lines, *format_mid_level(facts)) if line],
        "rla": "" if rla is None else rla.title,
        "features": [] if rla is None else _features(level, rla, words),
    }


def _leading(facts: DecisionFacts) -> tuple[LevelFacts, RlaFacts | None]:
    """Return the level that decided, and its RLA that drives or is nearest."""
    if facts.asks_at == MID and facts.mid is not None:
        return facts.mid, facts.mid.nearest
    driver = facts.basic.driver if facts.cause == DecisionCause.RLA else None
    return facts.basic, driver or facts.basic.nearest


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
