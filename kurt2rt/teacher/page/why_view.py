"""Why the robot does what it does, in words for a page."""

from typing import Any

from kurt2rt.core.decision.decision import Cause
from kurt2rt.core.perception.sensor_words import NO_WORDS, SensorWords
from kurt2rt.core.rla.rla import MID
from kurt2rt.runs.explain.attribution import shares
from kurt2rt.runs.explain.facts import DecisionFacts, LevelFacts, RlaFacts
from kurt2rt.runs.explain.reasons import because, headline
from kurt2rt.runs.explain.sentences import beside, guarded, mid_lines, taught, used

_FEATURES = 6


def why_view(number: int, facts: DecisionFacts | None, words: SensorWords = NO_WORDS) -> dict[str, Any]:
    """Return the answer to a page that asked why; there is nothing to explain before the first tick."""
    view = {"kind": "answer", "number": number, "accepted": True, "text": "nothing was decided yet"}
    if facts is None:
        return {**view, "lines": [], "features": []}
    level, story = _leading(facts)
    lines = [*because(facts), guarded(facts)]
    if story is not None:
        lines += [*beside(level), taught(story), used(story)]
    return {
        **view,
        "text": headline(facts),
        "tick": facts.tick,
        "lines": [line for line in (*lines, *mid_lines(facts)) if line],
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
        for each in shares(level, story)[:_FEATURES]
    ]
