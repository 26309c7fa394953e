"""Sentences of an explanation for terminal, page and picture."""

import math

from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.rla.rla import ASK
from kurt2rt.runs.explain.attribution import border_distance
from kurt2rt.runs.explain.counterfactual import SensorCounterfactual
from kurt2rt.runs.explain.facts import DecisionFacts, LessonFact, LevelFacts, RlaFacts


def format_runner_up(level: LevelFacts) -> list[str]:
    """Return sentences on the runner-up and the nearest RLA with another action, with their margins."""
    nearest, runner_up, otherwise = level.nearest, level.runner_up, level.otherwise
    if nearest is None:
        return []
    if runner_up is None:
        return [f"No other RLA competes: {nearest.title} is the only one."]
    lines = [
        f"The runner-up of {level.count} is {format_rla(runner_up)} "
        f"at {format_distance(runner_up.distance)}{_margin(level, runner_up)}."
    ]
    if otherwise is not None and otherwise is not runner_up:
        lines.append(
            f"It says the same. The nearest with another action is {format_rla(otherwise)} "
            f"at {format_distance(otherwise.distance)}{_margin(level, otherwise)}."
        )
    return lines


def format_counterfactuals(found: tuple[SensorCounterfactual, ...], most: int = 3) -> list[str]:
    """Return the changes of one reading that change the decision, smallest first."""
    return [
        f"{tip.label}{_readings(tip)} ({tip.sensor}: {tip.needed_counts} counts, not {tip.counts}): {_then(tip)}"
        for tip in found[:most]
    ]


def format_held(facts: DecisionFacts) -> str:
    """Return the sentence about an action held for its minimum time; empty if none is held."""
    if not facts.kept or facts.cause != DecisionCause.RLA or facts.latched:
        return ""
    return (
        f"{facts.kept} had not driven for its minimum time yet: until then no other action takes its place, "
        "whatever is seen."
    )


def format_teaching(rla: RlaFacts) -> str:
    """Return the teacher, time and content of the lesson that gave the RLA its action."""
    acts = [act for act in rla.acts if act.changes]
    if not acts:
        return f"Nothing is known of who taught {rla.title}."
    newest = acts[-1]
    return f"{newest.text}; {format_stamp(newest)}, by {newest.teacher} in phase {newest.phase}."


def format_usage(rla: RlaFacts) -> str:
    """Return the number of uses and the rewards."""
    text = f"Used {format_count(rla.uses)}" if rla.uses else "Never used"
    text += " since it was first taught"
    if rla.rewards or rla.punishments:
        text += f"; rewarded {format_count(rla.rewards)}, punished {format_count(rla.punishments)}"
        if rla.value is not None:
            text += f", value {rla.value:.2f}"
    return f"{text}."


def format_stamp(act: LessonFact) -> str:
    """Return the time to the second, and the tick of its run."""
    stamp = act.stamp[:19].replace("T", " ")
    return f"{stamp} UTC (tick {act.tick})" if stamp else f"tick {act.tick} of its run"


def format_nearness(rla: RlaFacts) -> str:
    """Return the distance of an RLA and its radius, such as "12.3 of R 20 (62 %)"."""
    share = rla.distance / rla.radius if rla.radius > 0 else math.inf
    percent = f" ({100 * share:.0f} %)" if math.isfinite(share) else ""
    return f"{format_distance(rla.distance)} of R {format_distance(rla.radius)}{percent}"


def format_distance(distance: float) -> str:
    """Return a weighted distance (dimensionless) with three digits."""
    if math.isinf(distance):
        return "far off"
    return f"{distance:.0f}" if distance >= 10 else f"{distance:.3g}"


def format_mid_level(facts: DecisionFacts) -> list[str]:
    """Return the command of the mid level and its reason; empty without a mid level."""
    mid = facts.mid
    if mid is None:
        return []
    came_by = f" Here: {', '.join(word for word in mid.words if word)}." if any(mid.words) else ""
    if facts.overridden:
        lines = [f"Mid level: a teacher commands {facts.basic.behaviour} until the next junction has been passed."]
    elif mid.driver is not None:
        rla = mid.driver
        lines = [
            f"Mid level: {rla.title} commands {rla.action}, at {format_nearness(rla)}.{came_by}",
            format_teaching(rla),
        ]
    else:
        lines = [f"Mid level: it asks; {why_the_way(mid)}.{'' if mid.lost else came_by}"]
    return [*lines, *([f"Goal: {facts.plan_says}"] if facts.plan_says else [])]


def why_the_way(mid: LevelFacts) -> str:
    """Return why the mid level asks, or would ask."""
    if mid.lost:
        return "no teacher has set the location of the robot"
    if mid.nearest is None:
        return "the mid level was taught nothing yet"
    nearest = f"nearest is {format_rla(mid.nearest)}, at {format_nearness(mid.nearest)}"
    return f"the mid level does not know the way from here: {nearest}"


def format_count(count: int) -> str:
    """Return never, once, twice or n times."""
    return ("never", "once", "twice")[count] if count < 3 else f"{count} times"


def format_rla(rla: RlaFacts) -> str:
    """Return the title of an RLA with its action."""
    return f"{rla.title} ({'asks again' if rla.action == ASK else rla.action})"


def _margin(level: LevelFacts, other: RlaFacts) -> str:
    nearest = level.nearest
    if nearest is None:
        return ""
    border = border_distance(level, nearest, other)
    return "" if border is None else f"; the border to it is {format_distance(border)} away"


def _readings(tip: SensorCounterfactual) -> str:
    # Less than a centimetre is told in counts alone.
    return "" if tip.needs == tip.reads else f" at {tip.needs} instead of {tip.reads}"


def _then(tip: SensorCounterfactual) -> str:
    if tip.rla is None:
        return "the robot would ask"
    if tip.action != tip.rla.action:
        return f"{format_rla(tip.rla)}, once {tip.action} had driven for its minimum time"
    return format_rla(tip.rla)
