"""Reasons for the robot's behaviour in sentences: an RLA, a teacher, a question or an obstacle."""

import math

from kurt2rt.core.decision.decision import DecisionCause, StandReason
from kurt2rt.core.decision.standing import (
    DRIVES,
    ActiveStop,
    Standing,
    reason_text,
    short_text,
    standing_for,
    standing_latched,
    stop_text,
    touched_bumper,
)
from kurt2rt.core.rla.rla import MID
from kurt2rt.runs.explain.facts import DecisionFacts, DoubtFacts, LevelFacts, RlaFacts
from kurt2rt.runs.explain.sentences import format_distance, format_nearness, format_rla, why_the_way

_TOLD_DOUBT = 1.0
"""Least doubt that is told of a robot that drives: that of 1 % of the ticks of a usual drive."""

_NOTHING_BESIDE = (
    *(DecisionCause.BLIND, DecisionCause.AT_GOAL, DecisionCause.NO_WAY),
    *(DecisionCause.LEARNER, DecisionCause.LEARNER_FAILED),
)
"""Causes without a hypothetical action: no situation, or what the robot itself decided."""


def headline(facts: DecisionFacts) -> str:
    """Return the robot's behaviour in a few words."""
    standing = standing_of(facts)
    if standing.reason is not StandReason.DRIVES:
        return short_text(standing) or f"stands and asks: {reason_text(standing)}"
    if facts.cause == DecisionCause.TEACHER:
        return f"{facts.action}: {facts.teacher or 'a teacher'} drives"
    return facts.action or ""


def format_decision(facts: DecisionFacts) -> str:
    """Return the robot's behaviour and its reasons, a line each."""
    return "\n".join([headline(facts), *format_reasons(facts)])


def standing_of(facts: DecisionFacts) -> Standing:
    """Return the reason to stand of the guard, or else of the decision; DRIVES if an action drives."""
    if facts.latched:
        return standing_latched(facts.reasons)
    if facts.cause == DecisionCause.TOUCHES or facts.action is not None:
        bumpers = touched_bumper(facts.granted, facts.reasons)
        if bumpers is not None:
            return Standing(bumpers, asks=facts.cause == DecisionCause.TOUCHES)
    return DRIVES if facts.action is not None else _standing_by(DecisionCause(facts.cause), facts, facts.stopped)


def _standing_by(cause: DecisionCause, facts: DecisionFacts, stop: ActiveStop | None = None) -> Standing:
    says = facts.trouble if cause is DecisionCause.LEARNER_FAILED else facts.plan_says
    return standing_for(cause, facts.asks_at, stop, says)


def format_reasons(facts: DecisionFacts) -> list[str]:
    """Return the reasons for the behaviour, the main one first, and what the guard made of it."""
    lines = []
    if facts.latched:
        lines.append(
            f"The guard stopped the robot for {', '.join(facts.reasons)}, and keeps it stopped until a teacher says Go."
        )
    if facts.cause == DecisionCause.RLA:
        lines += [*_rla_drives(facts.basic), *_passed_over(facts.basic), *_doubts_a_little(facts.doubt)]
    elif facts.cause == DecisionCause.HELD:
        lines += [*_held(facts.basic), *_passed_over(facts.basic), *_doubts_a_little(facts.doubt)]
    elif facts.cause == DecisionCause.DOUBT:
        lines += _doubts(facts.basic, facts.doubt)
    elif facts.cause == DecisionCause.TOUCHES:
        lines += _touches(facts)
    elif facts.cause == DecisionCause.UNKNOWN:
        of_way = facts.mid if facts.asks_at == MID else None
        lines.append(f"{_capital(_why_ask(facts.basic) if of_way is None else why_the_way(of_way))}.")
    else:
        lines.append(_sentence(facts))
        lines += _autonomous_action(facts)
    return [*lines, *_slow_lesson(facts), *_broken_sensors(facts), *_guard(facts)]


def _slow_lesson(facts: DecisionFacts) -> list[str]:
    if facts.lesson_speed == 1.0:
        return []
    return [f"It is a slow lesson: the robot drives at {100 * facts.lesson_speed:.0f} % of the speed of its actions."]


def _broken_sensors(facts: DecisionFacts) -> list[str]:
    """Describe the sensors that did not count in this decision."""
    return [
        f"The range sensor {title} is broken: the readings of the sensors next to it count in its place."
        for title in facts.broken_sensors
    ]


def _guard(facts: DecisionFacts) -> list[str]:
    if not facts.reasons or facts.latched or facts.cause == DecisionCause.TOUCHES:  # said already
        return []
    granted, decided = (f"{left:+.2f}/{right:+.2f} m/s" for left, right in (facts.granted, facts.decided))
    return [f"The guard let {granted} through instead of {decided}: {', '.join(facts.reasons)}."]


def _sentence(facts: DecisionFacts) -> str:
    """Return the sentence of a cause that is not about RLAs."""
    age = "never came" if math.isinf(facts.infrared_age_s) else f"are {facts.infrared_age_s * 1000:.0f} ms old"
    return DecisionCause(facts.cause).text.format(
        teacher=facts.teacher or "A teacher",
        action=facts.action,
        age=age,
        stop=stop_text(facts.stopped) or "a teacher said so",
        trouble=f" ({facts.trouble})" if facts.trouble else "",
        plan=facts.plan_says or facts.cause,
    )


def _rla_drives(level: LevelFacts) -> list[str]:
    nearest, driver = level.nearest, level.driver
    if nearest is None:
        return ["What drove is not among the RLAs any more."]
    if driver is None or driver.name == nearest.name:
        return [f"This is like {nearest.title}, which says {nearest.action}: distance {format_nearness(nearest)}."]
    worth = "" if driver.value is None else f" and has the value {driver.value:.2f}"
    return [
        f"This is like {nearest.title}: distance {format_nearness(nearest)}. "
        f"Of those on the very same condition {driver.title} was chosen, which says {driver.action}{worth}."
    ]


def _held(level: LevelFacts) -> list[str]:
    nearest, driver = level.nearest, level.driver
    if driver is None or nearest is None:
        return ["An action keeps its minimum time."]
    return [
        f"{driver.title} ({driver.action}) was chosen a moment ago, and its action keeps its minimum time.",
        f"Nearest by now is {format_rla(nearest)}, at {format_nearness(nearest)}.",
    ]


def _passed_over(level: LevelFacts) -> list[str]:
    """Describe the nearest of the RLAs that do not answer without a teacher."""
    rla = level.passed_over
    if rla is None:
        return []
    why = "its action was withdrawn" if rla.asks else "it came from a held action, and the RLAs near it act otherwise"
    return [f"{format_rla(rla)} is nearer, at {format_nearness(rla)}. Without a teacher it does not answer: {why}."]


def _touches(facts: DecisionFacts) -> list[str]:
    why, leader = reason_text(standing_of(facts)), facts.basic.leader
    says = "an RLA goes on toward it" if leader is None else f"{format_rla(leader)} goes on toward it"
    return [f"{_capital(why)}, and {says}: the guard lets no wheel turn that way, so the robot asks."]


def _doubts(level: LevelFacts, doubt: DoubtFacts | None) -> list[str]:
    leader = level.leader
    if leader is None or doubt is None:
        return ["The robot doubts its action, so it asks."]
    return [
        f"{format_rla(leader)} would drive, at {format_nearness(leader)}, but the robot doubts it and asks. "
        f"Reason: {_why_doubt(doubt)}. {_measure(doubt)}."
    ]


def _doubts_a_little(doubt: DoubtFacts | None) -> list[str]:
    if doubt is None or doubt.score < _TOLD_DOUBT:
        return []
    return [f"{_measure(doubt)}: {_why_doubt(doubt)}."]


def _measure(doubt: DoubtFacts) -> str:
    return f"Doubt {doubt.score:.1f}, it asks from {doubt.threshold:.1f}"


def _why_doubt(doubt: DoubtFacts) -> str:
    if doubt.contact is not None:
        contact = doubt.contact
        seen = f"what {contact.sensor} saw {contact.seen_s:.1f} s ago"
        return f"{contact.action} would meet in {contact.within_s:.1f} s {seen}"
    if not doubt.sensor:
        return "the situation is farther from the lesson than usual"
    return f"{doubt.sensor} sees {doubt.reads}, and lessons to drive on reach {doubt.taught}"


def _why_ask(level: LevelFacts) -> str:
    """Return why the basic level asks, or would ask."""
    nearest, of = level.nearest, f" of {level.behaviour}" if level.behaviour else ""
    if nearest is None and level.count:
        return f"a learner without RLAs decides{of}, and does not know this situation"
    if nearest is None:
        return f"nothing{of} was taught yet"
    if nearest.distance <= nearest.radius:
        if nearest.asks:
            return f"this is like {nearest.title}, at {format_nearness(nearest)}, whose action was withdrawn"
        return f"{nearest.title} says {nearest.action}, which does not know how to go on here"
    far = f"no RLA{of} is near enough: the nearest is {format_rla(nearest)}, at {format_distance(nearest.distance)}"
    if not (nearest.radius > 0 and math.isfinite(nearest.distance)):
        return far
    return f"{far}, {nearest.distance / nearest.radius:.2f} times {_limit(level, nearest)}"


def _limit(level: LevelFacts, nearest: RlaFacts) -> str:
    """Return the distance beyond which the robot asks, such as "R (900)"."""
    limit = format_distance(nearest.radius)
    if level.radius_share >= 1.0:
        return f"R ({limit})"
    whole = format_distance(nearest.radius / level.radius_share)
    return f"{level.radius_share:g} R ({limit} of {whole}), its limit while it is taught"


def _autonomous_action(facts: DecisionFacts) -> list[str]:
    """Describe what the robot would do without the stop, the manual driving or the blocking cause."""
    if facts.cause in _NOTHING_BESIDE:
        return []
    others = [DecisionCause(each) for each in facts.hindrances if each != facts.cause]
    unable = next((each for each in others if each in (DecisionCause.BLIND, DecisionCause.UNSAVED)), None)
    if unable is not None:
        return [_would_stand(unable, facts)]
    if facts.asks_at == MID and facts.mid is not None:
        return [f"By itself it would ask the way: {why_the_way(facts.mid)}."]
    nearest, leader = facts.basic.nearest, facts.basic.leader
    known = nearest is not None and nearest.distance <= nearest.radius and not nearest.asks
    stands = next(iter(others), None)
    if DecisionCause.UNATTENDED in others:  # without a teacher it still asks about an unknown situation
        stands = DecisionCause.UNATTENDED if known else None
    if stands is not None:
        return [_would_stand(stands, facts)]
    if nearest is None and facts.basic.count:
        return ["By itself it would do as its learner decides, which has no RLAs."]
    if known and leader is not None:
        return [f"By itself it would do as {format_rla(leader)} says, at {format_nearness(leader)}."]
    return [f"By itself it would ask: {_why_ask(facts.basic)}."]


def _would_stand(cause: DecisionCause, facts: DecisionFacts) -> str:
    return f"By itself it would stand: {reason_text(_standing_by(cause, facts))}."


def _capital(text: str) -> str:
    return text[0].upper() + text[1:]
