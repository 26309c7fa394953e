"""An explanation in sentences, for a terminal, a page or a picture's heading."""

import math

from kurt2rt.core.decision.decision import Cause
from kurt2rt.core.rla.rla import ASK
from kurt2rt.runs.explain.attribution import to_the_border
from kurt2rt.runs.explain.counterfactual import SensorCounterfactual
from kurt2rt.runs.explain.facts import DecisionFacts, LessonFact, LevelFacts, RlaFacts


def beside(level: LevelFacts) -> list[str]:
    """Who else was near, and how much was between them."""
    nearest, runner_up, otherwise = level.nearest, level.runner_up, level.otherwise
    if nearest is None:
        return []
    if runner_up is None:
        return [f"No other RLA competes: {nearest.title} is the only one."]
    lines = [
        f"The runner-up of {level.count} is {who(runner_up)} at {far(runner_up.distance)}{_margin(level, runner_up)}."
    ]
    if otherwise is not None and otherwise is not runner_up:
        lines.append(
            f"It says the same; the nearest that says something else is {who(otherwise)} "
            f"at {far(otherwise.distance)}{_margin(level, otherwise)}."
        )
    return lines


def would_change(found: tuple[SensorCounterfactual, ...], most: int = 3) -> list[str]:
    """What would have had to be otherwise for the robot to do something else, the smallest change first."""
    return [
        f"{tip.label}{_readings(tip)} ({tip.sensor}: {tip.needed_counts} counts, not {tip.counts}): {_then(tip)}"
        for tip in found[:most]
    ]


def still_kept(facts: DecisionFacts) -> str:
    """Why no other action could have been taken just then; empty where one could."""
    if not facts.kept or facts.cause != Cause.RLA or facts.latched:
        return ""
    return (
        f"{facts.kept} had not driven for its minimum time yet: until then no other action takes its place, "
        "whatever is seen."
    )


def guarded(facts: DecisionFacts) -> str:
    """What the guard made of the decision; empty where it let it through."""
    if not facts.reasons or facts.latched or facts.cause == Cause.TOUCHES:  # said already
        return ""
    return (
        f"The guard let {_speeds(facts.granted)} through instead of {_speeds(facts.decided)}: "
        f"{', '.join(facts.reasons)}."
    )


def taught(story: RlaFacts) -> str:
    """Who taught the action that it has, when, and instead of what."""
    acts = teaching_acts(story)
    if not acts:
        return f"Nothing is known of who taught {story.title}."
    newest = acts[-1]
    return f"{newest.text}; {when(newest)}, by {newest.teacher} in phase {newest.phase}."


def teaching_acts(story: RlaFacts) -> tuple[LessonFact, ...]:
    """The lessons that stand and made its action, oldest first; praise and blame left out."""
    return tuple(act for act in story.acts if act.changes)


def used(story: RlaFacts) -> str:
    """How often, and what teachers thought of it."""
    count = story.uses if story.uses_since is None else story.uses_since
    text = f"Used {times(count)}" if count else "Never used"
    if story.uses_since is None:
        text += " since it was first taught"
    elif story.uses_since == story.uses:
        text += " since"
    else:
        text += f" since, {times(story.uses)} with the actions it had before"
    if story.rewards or story.punishments:
        text += f"; praised {times(story.rewards)}, blamed {times(story.punishments)}"
        if story.value is not None:
            text += f", worth {story.value:.2f}"
    return f"{text}."


def when(act: LessonFact) -> str:
    """To the second, and the tick of its run."""
    stamp = act.stamp[:19].replace("T", " ")
    return f"{stamp} UTC (tick {act.tick})" if stamp else f"tick {act.tick} of its run"


def far(distance: float) -> str:
    """A distance for people to read."""
    if math.isinf(distance):
        return "far off"
    return f"{distance:.0f}" if distance >= 10 else f"{distance:.3g}"


def number(value: float) -> str:
    """Counts whole, metres and shares with their decimals."""
    return f"{value:.0f}" if abs(value) >= 10 else f"{value:.2f}".rstrip("0").rstrip(".")


def mid_lines(facts: DecisionFacts) -> list[str]:
    """What the level above commands, and why; empty where there is none."""
    mid = facts.mid
    if mid is None:
        return []
    came_by = f" Here: {', '.join(word for word in mid.words if word)}." if any(mid.words) else ""
    if facts.overridden:
        lines = [f"Mid level: a teacher commands {facts.basic.behaviour} until the next junction has been passed."]
    elif mid.driver is not None:
        story = mid.driver
        lines = [
            f"Mid level: {story.title} commands {story.action}, at {far(story.distance)} of R {far(story.radius)}."
            f"{came_by}",
            taught(story),
        ]
    else:
        lost = ", for it is lost: nobody has said where it was set down" if mid.lost else ""
        lines = [f"Mid level: it asks{lost}.{'' if mid.lost else came_by}"]
    return [*lines, *([f"Goal: {facts.plan_says}"] if facts.plan_says else [])]


def times(count: int) -> str:
    """How often."""
    return ("never", "once", "twice")[count] if count < 3 else f"{count} times"


def who(story: RlaFacts) -> str:
    """An RLA with what it says."""
    return f"{story.title} ({'asks again' if story.action == ASK else story.action})"


def _margin(level: LevelFacts, other: RlaFacts) -> str:
    nearest = level.nearest
    if nearest is None:
        return ""
    border = to_the_border(level, nearest, other)
    return "" if border is None else f"; the border to it is {far(border)} away"


def _readings(tip: SensorCounterfactual) -> str:
    # Less than a centimetre is told in counts alone.
    return "" if tip.needs == tip.reads else f" at {tip.needs} instead of {tip.reads}"


def _then(tip: SensorCounterfactual) -> str:
    if tip.rla is None:
        return "the robot would ask"
    if tip.action != tip.rla.action:
        return f"{who(tip.rla)}, once {tip.action} had driven for its minimum time"
    return who(tip.rla)


def _speeds(speeds: tuple[float, float]) -> str:
    left_m_s, right_m_s = speeds
    return f"{left_m_s:+.2f}/{right_m_s:+.2f} m/s"
