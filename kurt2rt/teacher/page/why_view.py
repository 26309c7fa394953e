"""Why the robot does what it does, in words for a page."""

from typing import Any

from kurt2rt.core.decision.decision import Cause
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

_FEATURES = 6


def why_view(number: int, facts: DecisionFacts | None, words: SensorWords = NO_WORDS) -> dict[str, Any]:
    """Return the answer to a page that asked why; there is nothing to explain before the first tick."""
    view = {"kind": "answer", "number": number, "accepted": True, "text": "nothing was decided yet"}
    if facts is None:
        return {**view, "lines": [], "features": []}
    level, story = _leading(facts)
    lines = [*format_reasons(facts), format_guard(facts)]
    if story is not None:
        lines += [*format_runner_up(level), format_teaching(story), format_usage(story)]
    return {
        **view,
        "text": headline(facts),
        "tick": facts.tick,
        "lines": [line for line in (*lines, *format_mid_level(facts)) if line],
        "rla": "" if story is None else story.title,
        "features": [] if story is None else _features(level, story, words),
    }


def _leading(facts: DecisionFacts) -> tuple[LevelFacts, RlaFacts | None]:
    """The level that it went by, and the RLA there that drives, or is nearest."""
    if facts.asks_at == MID and facts.mid is not None:
        return facts.mid, facts.mid.nearest
    driver = facts.basic.driver if facts.cause == Cause.RLA else None
    return facts.basic, driver or facts.basic.nearest


def _features(level: LevelFacts, story: RlaFacts, words: SensorWords) -> list[dict[str, Any]]:
    return [
        {
            "name": words.place(each.name),
            "here": words.reading(each.name, each.here),
            "there": words.reading(each.name, each.there),
            "share": round(each.share, 3),
        }
        for each in distance_attribution(level, story)[:_FEATURES]
    ]
