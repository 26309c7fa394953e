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
from kurt2rt.runs.explain.facts import ContactFacts, DecisionFacts, DoubtFacts, LevelFacts, RlaFacts
from kurt2rt.runs.explain.sentences import format_distance, format_nearness, format_rla

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
    """Return the reasons for the behaviour, the main one first."""
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
        lines += _asks_the_way(facts.mid) if facts.asks_at == MID and facts.mid is not None else _asks(facts.basic)
    else:
        lines.append(_sentence(facts))
        lines += _autonomous_action(facts)
    return [*lines, *_slow_lesson(facts), *_broken_sensors(facts)]


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
    lines = [
        f"This is like {nearest.title}, which says {nearest.action}: "
        f"distance {format_nearness(nearest)}{_format_percent(nearest)}."
    ]
    if driver is not None and driver.rla_id != nearest.rla_id:
        lines[0] = (
            f"This is like {nearest.title}: distance {format_nearness(nearest)}"
            f"{_format_percent(nearest)}. Of those on the very same condition {driver.title} was chosen, which says "
            f"{driver.action}{_format_value(driver)}."
        )
    return lines


def _held(level: LevelFacts) -> list[str]:
    nearest, driver = level.nearest, level.driver
    if driver is None or nearest is None:
        return ["An action keeps its minimum time."]
    return [
        f"{driver.title} ({driver.action}) was chosen a moment ago, and its action keeps its minimum time.",
        f"Nearest by now is {format_rla(nearest)}, at {format_nearness(nearest)}{_format_percent(nearest)}.",
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
    return [f"{why[0].upper()}{why[1:]}, and {says}: the guard lets no wheel turn that way, so the robot asks."]


def _doubts(level: LevelFacts, doubt: DoubtFacts | None) -> list[str]:
    leader = level.leader
    if leader is None or doubt is None:
        return ["The robot doubts its action, so it asks."]
    return [
        f"{format_rla(leader)} would drive, at {format_nearness(leader)}, but the robot doubts it and asks. "
        f"Reason: {_why_doubt(doubt)}. Doubt {doubt.score:.1f}, it asks from {doubt.threshold:.1f}."
    ]


def _format_contact(contact: ContactFacts) -> str:
    return (
        f"{contact.action} would meet in {contact.within_s:.1f} s what {contact.sensor} saw {contact.seen_s:.1f} s ago"
    )


def _doubts_a_little(doubt: DoubtFacts | None) -> list[str]:
    if doubt is None or doubt.score < _TOLD_DOUBT:
        return []
    return [f"Doubt {doubt.score:.1f}, it asks from {doubt.threshold:.1f}: {_why_doubt(doubt)}."]


def _why_doubt(doubt: DoubtFacts) -> str:
    if doubt.contact is not None:
        return _format_contact(doubt.contact)
    if not doubt.sensor:
        return "the situation is farther from the lesson than usual"
    return f"{doubt.sensor} sees {doubt.reads}, and lessons to drive on reach {doubt.taught}"


def _asks(level: LevelFacts) -> list[str]:
    nearest, of = level.nearest, f" of {level.behaviour}" if level.behaviour else ""
    if nearest is None and level.count:
        return [f"A learner without RLAs decides{of}, and does not know this situation: the robot asks."]
    if nearest is None:
        return [f"Nothing{of} was taught yet, so the robot asks."]
    if nearest.distance <= nearest.radius:
        if nearest.asks:
            return [
                f"This is like {nearest.title}, at {format_nearness(nearest)}, "
                "whose action was withdrawn: there the robot asks."
            ]
        return [f"{nearest.title} says {nearest.action}, which does not know how to go on here: the robot asks."]
    return [
        f"No RLA{of} is near enough: the nearest is {format_rla(nearest)}, at {format_distance(nearest.distance)}, "
        f"{nearest.distance / nearest.radius:.2f} times {_limit(level, nearest)}."
        if nearest.radius > 0 and math.isfinite(nearest.distance)
        else f"No RLA{of} is near enough: the nearest is {format_rla(nearest)}, {format_distance(nearest.distance)}."
    ]


def _limit(level: LevelFacts, nearest: RlaFacts) -> str:
    """Return the distance beyond which the robot asks, such as "R (900)"."""
    limit = format_distance(nearest.radius)
    if level.radius_share >= 1.0:
        return f"R ({limit})"
    whole = format_distance(nearest.radius / level.radius_share)
    return f"{level.radius_share:g} R ({limit} of {whole}), its limit while it is taught"


def _asks_the_way(level: LevelFacts) -> list[str]:
    nearest = level.nearest
    if level.lost:
        return ["The robot is lost: no teacher has set its location, so it asks."]
    if nearest is None:
        return ["The mid level was taught nothing yet, so the robot asks which behaviour to follow."]
    return [f"The mid level does not know the way from here: {_format_nearest(nearest)}."]


def _autonomous_action(facts: DecisionFacts) -> list[str]:
    """Describe what the robot would do without the stop, the manual driving or the blocking cause."""
    if facts.cause in _NOTHING_BESIDE:
        return []
    others = [DecisionCause(each) for each in facts.hindrances if each != facts.cause]
    unable = next((each for each in others if each in (DecisionCause.BLIND, DecisionCause.UNSAVED)), None)
    if unable is not None:
        return [_would_stand(unable, facts)]
    if facts.asks_at == MID and facts.mid is not None:
        return [f"By itself it would ask the way: {_why_the_way(facts.mid)}."]
    nearest, leader = facts.basic.nearest, facts.basic.leader
    known = nearest is not None and nearest.distance <= nearest.radius and not nearest.asks
    stands = next(iter(others), None)
    if DecisionCause.UNATTENDED in others:  # without a teacher it still asks about an unknown situation
        stands = DecisionCause.UNATTENDED if known else None
    if stands is not None:
        return [_would_stand(stands, facts)]
    if nearest is None and facts.basic.count:
        return ["By itself it would do as its learner decides, which has no RLAs."]
    if nearest is None or leader is None:
        return ["By itself it would ask: nothing was taught yet."]
    if known:
        return [f"By itself it would do as {format_rla(leader)} says, at {format_nearness(leader)}."]
    return [f"By itself it would ask: {_format_nearest(nearest)}."]


def _would_stand(cause: DecisionCause, facts: DecisionFacts) -> str:
    return f"By itself it would stand: {reason_text(_standing_by(cause, facts))}."


def _why_the_way(mid: LevelFacts) -> str:
    if mid.lost:
        return "it is lost, because no teacher has set its location"
    if mid.nearest is None:
        return "the mid level was taught nothing yet"
    return _format_nearest(mid.nearest)


def _format_nearest(rla: RlaFacts) -> str:
    return f"nearest is {format_rla(rla)}, at {format_nearness(rla)}"


def _format_percent(rla: RlaFacts) -> str:
    if not rla.radius > 0 or math.isinf(rla.distance):
        return ""
    return f" ({100 * rla.distance / rla.radius:.0f} %)"


def _format_value(rla: RlaFacts) -> str:
    return "" if rla.value is None else f" and has the value {rla.value:.2f}"
