"""An explanation in sentences, for a terminal, a page or a picture's heading."""

import math

from kurt2rt.explain.facts import Act, DecisionFacts, LevelFacts, RlaStory
from kurt2rt.explain.shares import to_the_border
from kurt2rt.explain.tipping import Tip
from kurt2rt.layers.decision import Cause
from kurt2rt.rla.rla import ASK, MID


def headline(facts: DecisionFacts) -> str:
    """What the robot does, in a few words."""
    if facts.latched:
        return f"stands: stopped by the guard ({', '.join(facts.reasons)})"
    if facts.action is not None:
        if facts.cause == Cause.TEACHER:
            return f"{facts.action}: {facts.teacher or 'a teacher'} drives"
        return facts.action
    if facts.cause == Cause.UNKNOWN:
        return "stands and asks the way" if facts.asks_at == MID else "stands and asks"
    return f"stands: {_STANDS.get(Cause(facts.cause), facts.cause)}"


def because(facts: DecisionFacts) -> list[str]:
    """Why it does so, the main reason first."""
    lines = []
    if facts.latched:
        lines.append(
            f"The guard stopped the robot for {', '.join(facts.reasons)}, and keeps it stopped until a teacher says Go."
        )
    if facts.cause == Cause.RLA:
        lines += _rla_drives(facts.basic)
    elif facts.cause == Cause.HELD:
        lines += _held(facts.basic)
    elif facts.cause == Cause.TEACHER:
        lines.append(f"{facts.teacher or 'A teacher'} drives: {facts.action}. No RLA was asked.")
        lines += _would(facts.basic)
    elif facts.cause == Cause.UNKNOWN:
        lines += _asks_the_way(facts.mid) if facts.asks_at == MID and facts.mid is not None else _asks(facts.basic)
    else:
        lines.append(_stands(facts))
        lines += _would(facts.basic)
    return lines


def beside(level: LevelFacts) -> list[str]:
    """Who else was near, and how much was between them."""
    nearest, runner_up, otherwise = level.nearest, level.runner_up, level.otherwise
    if nearest is None:
        return []
    if runner_up is None:
        return [f"No other RLA competes: {nearest.title} is the only one."]
    lines = [
        f"The runner-up of {level.count} is {_who(runner_up)} at {far(runner_up.distance)}{_margin(level, runner_up)}."
    ]
    if otherwise is not None and otherwise is not runner_up:
        lines.append(
            f"It says the same; the nearest that says something else is {_who(otherwise)} "
            f"at {far(otherwise.distance)}{_margin(level, otherwise)}."
        )
    return lines


def would_change(found: tuple[Tip, ...], most: int = 3) -> list[str]:
    """What would have had to be otherwise for the robot to do something else, the smallest change first."""
    return [
        f"{tip.sensor} ({tip.label}) at {tip.needed_counts} instead of {tip.counts} counts"
        f"{_metres(tip)}: {'the robot would ask' if tip.rla is None else _who(tip.rla)}"
        for tip in found[:most]
    ]


def guarded(facts: DecisionFacts) -> str:
    """What the guard made of the decision; empty where it let it through."""
    if not facts.reasons or facts.latched:
        return ""
    return (
        f"The guard let {_speeds(facts.granted)} through instead of {_speeds(facts.decided)}: "
        f"{', '.join(facts.reasons)}."
    )


def taught(story: RlaStory) -> str:
    """Who taught the action that it has, when, and instead of what."""
    acts = teaching_acts(story)
    if not acts:
        return f"Nothing is known of who taught {story.title}."
    newest = acts[-1]
    return f"{newest.text}; {when(newest)}, by {newest.teacher} in phase {newest.phase}."


def teaching_acts(story: RlaStory) -> tuple[Act, ...]:
    """The lessons that stand and made its action, oldest first; praise and blame left out."""
    return tuple(act for act in story.acts if act.changes)


def used(story: RlaStory) -> str:
    """How often, and what teachers thought of it."""
    text = "Used " + times(story.uses if story.uses_since is None else story.uses_since)
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


def when(act: Act) -> str:
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
        lines = [f"Mid level: it asks.{came_by}"]
    return [*lines, *([f"Goal: {facts.plan_says}"] if facts.plan_says else [])]


_STANDS = {
    Cause.BLIND: "it sees nothing",
    Cause.STOPPED: "it was stopped",
    Cause.UNATTENDED: "no teacher is there",
    Cause.UNSAVED: "lessons cannot be saved",
    Cause.AT_GOAL: "it is at its goal",
    Cause.NO_WAY: "no way leads to its goal",
}


def _stands(facts: DecisionFacts) -> str:
    match facts.cause:
        case Cause.BLIND:
            age = "never came" if math.isinf(facts.infrared_age_s) else f"are {facts.infrared_age_s * 1000:.0f} ms old"
            return f"The infra-red readings {age}: there is no situation to decide on, nor to ask about."
        case Cause.STOPPED:
            return f"The robot was stopped: {facts.stopped_because or 'a teacher said so'}. It waits for Go."
        case Cause.UNATTENDED:
            return "The robot knows what to do, but drives only while a teacher is there, and none is."
        case Cause.UNSAVED:
            why = f" ({facts.trouble})" if facts.trouble else ""
            return f"Lessons cannot be saved at the moment{why}: the robot stands until they can."
        case Cause.AT_GOAL | Cause.NO_WAY:
            return f"{facts.plan_says or _STANDS[Cause(facts.cause)]}."
    return f"Cause: {facts.cause}."


def _rla_drives(level: LevelFacts) -> list[str]:
    nearest, driver = level.nearest, level.driver
    if nearest is None:
        return ["What drove is not among the RLAs any more."]
    lines = [
        f"This is like {nearest.title}, which says {nearest.action}: "
        f"distance {far(nearest.distance)} of R {far(nearest.radius)}{_percent(nearest)}."
    ]
    if driver is not None and driver.rla_id != nearest.rla_id:
        lines[0] = (
            f"This is like {nearest.title}: distance {far(nearest.distance)} of R {far(nearest.radius)}"
            f"{_percent(nearest)}. Of those on the very same condition {driver.title} was chosen, which says "
            f"{driver.action}{_worth(driver)}."
        )
    return lines


def _held(level: LevelFacts) -> list[str]:
    nearest, driver = level.nearest, level.driver
    if driver is None or nearest is None:
        return ["An action keeps its minimum time."]
    return [
        f"{driver.title} ({driver.action}) was chosen a moment ago, and its action keeps its minimum time.",
        f"Nearest by now is {_who(nearest)}, at {far(nearest.distance)} of R {far(nearest.radius)}{_percent(nearest)}.",
    ]


def _asks(level: LevelFacts) -> list[str]:
    nearest, of = level.nearest, f" of {level.behaviour}" if level.behaviour else ""
    if nearest is None:
        return [f"Nothing{of} was taught yet, so the robot asks."]
    if nearest.distance <= nearest.radius:
        if nearest.asks:
            return [
                f"This is like {nearest.title}, at {far(nearest.distance)} of R {far(nearest.radius)}, "
                "whose action was withdrawn: there the robot asks."
            ]
        return [f"{nearest.title} says {nearest.action}, which does not know how to go on here: the robot asks."]
    return [
        f"No RLA{of} is near enough: the nearest is {_who(nearest)}, at {far(nearest.distance)}, "
        f"{nearest.distance / nearest.radius:.2f} times R ({far(nearest.radius)})."
        if nearest.radius > 0 and math.isfinite(nearest.distance)
        else f"No RLA{of} is near enough: the nearest is {_who(nearest)}, {far(nearest.distance)}."
    ]


def _asks_the_way(level: LevelFacts) -> list[str]:
    nearest = level.nearest
    if nearest is None:
        return ["The mid level was taught nothing yet, so the robot asks which behaviour to follow."]
    if math.isinf(nearest.distance):
        return ["The robot does not know where it is, so it asks."]
    return [
        f"The mid level does not know the way from here: nearest is {_who(nearest)}, at {far(nearest.distance)} "
        f"of R {far(nearest.radius)}."
    ]


def _would(level: LevelFacts) -> list[str]:
    nearest = level.nearest
    if nearest is None:
        return []
    if nearest.distance <= nearest.radius and not nearest.asks:
        return [
            f"By itself it would do as {_who(nearest)} says, at {far(nearest.distance)} of R {far(nearest.radius)}."
        ]
    return [
        f"By itself it would ask: nearest is {_who(nearest)}, at {far(nearest.distance)} of R {far(nearest.radius)}."
    ]


def times(count: int) -> str:
    """How often."""
    return ("never", "once", "twice")[count] if count < 3 else f"{count} times"


def _who(story: RlaStory) -> str:
    return f"{story.title} ({'asks again' if story.action == ASK else story.action})"


def _percent(story: RlaStory) -> str:
    if not story.radius > 0 or math.isinf(story.distance):
        return ""
    return f" ({100 * story.distance / story.radius:.0f} %)"


def _margin(level: LevelFacts, other: RlaStory) -> str:
    nearest = level.nearest
    if nearest is None:
        return ""
    border = to_the_border(level, nearest, other)
    return "" if border is None else f"; the border to it is {far(border)} away"


def _worth(story: RlaStory) -> str:
    return "" if story.value is None else f" and is worth {story.value:.2f}"


def _metres(tip: Tip) -> str:
    if abs(tip.distance_m - tip.needed_m) < 0.005:
        return ""
    return f" ({tip.needed_m:.2f} m, not {tip.distance_m:.2f} m)"


def _speeds(speeds: tuple[float, float]) -> str:
    left_m_s, right_m_s = speeds
    return f"{left_m_s:+.2f}/{right_m_s:+.2f} m/s"
