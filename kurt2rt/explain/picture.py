"""A decision as a picture: the situation beside the one that was taught, how near all RLAs were, what differed."""

import math
from collections.abc import Mapping
from pathlib import Path
from textwrap import fill

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec

from hal.robot_settings import RobotSettings
from kurt2rt.explain.colours import ASKS, INK, PALE_INK, STANDS, TEACHER, colours_of, ink_on
from kurt2rt.explain.facts import DecisionFacts, LevelFacts, RlaStory
from kurt2rt.explain.mid_picture import draw_mid
from kurt2rt.explain.saving import save
from kurt2rt.explain.sentences import because, far, guarded, headline, mid_lines, number, taught, used, would_change
from kurt2rt.explain.shares import pulls, shares
from kurt2rt.explain.surroundings import DIFFERS, LEGEND, Mark, draw_surroundings
from kurt2rt.explain.tipping import Tip
from kurt2rt.layers.decision import Cause
from kurt2rt.perception.definition import AVERAGED
from kurt2rt.rla.rla import MID

_FEATURES, _FEATURES_BELOW_MID = 7, 4
_POINTED_AT = 4
_MARKS = 1
_WORTH_POINTING = 0.03
_KNOWN = "#e3f1e6"


def draw_why(facts: DecisionFacts, found: tuple[Tip, ...], robot: RobotSettings, title: str, path: Path) -> None:
    """Write a picture as the file's name ends; `found`: what would have changed it. Raises OSError."""
    level = facts.basic
    story = level.driver if facts.cause == Cause.RLA and level.driver is not None else level.nearest
    known = (*([] if story is None else [story]), *level.others)
    said = [story.action for story in known] + ([facts.action] if facts.action else [])
    if facts.mid is not None:
        said += [each.action for each in (facts.mid.nearest, *facts.mid.others) if each is not None]
    colours = colours_of(said)
    figure = Figure(figsize=(14.5, 9.2), facecolor="white")
    top = _heading(figure, facts, found, title, colours)
    grid = figure.add_gridspec(
        2,
        3,
        left=0.015,
        right=0.98,
        top=top,
        bottom=0.085,
        width_ratios=(1.0, 1.0, 0.95),
        height_ratios=(1.0, 0.13),
        wspace=0.05,
        hspace=0.13,
    )
    _situations(figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[0, 1]), facts, found, robot, story, colours)
    _nearness(figure.add_subplot(grid[1, 0:2]), level, story, colours)
    _right_column(figure, grid[:, 2], facts, story, colours)
    figure.text(0.02, 0.014, LEGEND, fontsize=8.5, color=PALE_INK)
    save(figure, path)


def _right_column(
    figure: Figure, spec: SubplotSpec, facts: DecisionFacts, story: RlaStory | None, colours: Mapping[str, str]
) -> None:
    """What mattered: at the level that decided, with the level above where there is one."""
    level, mid = facts.basic, facts.mid
    if mid is not None and facts.asks_at == MID:
        right = spec.subgridspec(2, 1, hspace=0.3, height_ratios=(2.0, 1.0))
        draw_mid(figure.add_subplot(right[0]), mid, colours)
        _differences(figure.add_subplot(right[1]), mid, mid.nearest, _FEATURES_BELOW_MID)
        return
    rows = _FEATURES if mid is None else _FEATURES_BELOW_MID
    if mid is None:
        right = spec.subgridspec(2, 1, hspace=0.42)
    else:
        right = spec.subgridspec(3, 1, hspace=0.42, height_ratios=(1.5, 1.0, 1.0))
        draw_mid(figure.add_subplot(right[0]), mid, colours)
    _differences(figure.add_subplot(right[-2]), level, story, rows)
    _tug_of_war(figure.add_subplot(right[-1]), level, story, colours, rows)


def _heading(
    figure: Figure, facts: DecisionFacts, found: tuple[Tip, ...], title: str, colours: Mapping[str, str]
) -> float:
    """The decision in words; returns how high the rest may reach."""
    colour = _colour_of(facts, colours)
    figure.text(0.02, 0.967, title, fontsize=10.5, color=PALE_INK, va="center")
    figure.text(
        0.025,
        0.922,
        headline(facts),
        fontsize=20,
        fontweight="bold",
        color=ink_on(colour),
        va="center",
        bbox={"boxstyle": "round,pad=0.28", "facecolor": colour, "edgecolor": "none"},
    )
    changes = would_change(found, most=1)
    lines = [
        *because(facts),
        *([f"It would have been otherwise with {changes[0]}."] if changes else []),
        *mid_lines(facts)[:1],
        *([guarded(facts)] if guarded(facts) else []),
    ]
    text = "\n".join(fill(line, 178) for line in lines)
    figure.text(0.02, 0.886, text, fontsize=10.5, color=INK, va="top", linespacing=1.4)
    return 0.83 - 0.023 * text.count("\n")


def _colour_of(facts: DecisionFacts, colours: Mapping[str, str]) -> str:
    if facts.action is not None and not facts.latched:
        return TEACHER if facts.cause == Cause.TEACHER else colours[facts.action]
    return ASKS if facts.cause == Cause.UNKNOWN and not facts.latched else STANDS


def _situations(
    here: Axes,
    there: Axes,
    facts: DecisionFacts,
    found: tuple[Tip, ...],
    robot: RobotSettings,
    story: RlaStory | None,
    colours: Mapping[str, str],
) -> None:
    level, sensors = facts.basic, robot.infrared.names
    pointed_at: set[str] = set()
    if story is not None:
        differing = [share.name for share in shares(level, story) if share.share >= _WORTH_POINTING]
        pointed_at = set([name for name in differing if name in sensors][:_POINTED_AT])
    decided, granted = facts.decided, facts.granted
    motion = granted if facts.latched else decided
    counts, averages = _halves(level.names, level.vector, sensors)
    draw_surroundings(
        here,
        robot,
        counts,
        averages,
        differing=pointed_at,
        marks=[_mark(tip, colours) for tip in found[:_MARKS]],
        motion=motion,
        colour=_colour_of(facts, colours),
    )
    here.set_title(f"Now: tick {facts.tick}", fontsize=13, fontweight="bold", color=INK)
    if story is None:
        there.set_axis_off()
        there.text(0.5, 0.5, "nothing was taught yet", ha="center", va="center", color=PALE_INK, fontsize=13)
        return
    counts, averages = _halves(level.names, story.condition, sensors)
    draw_surroundings(there, robot, counts, averages, differing=pointed_at)
    says = "asks again" if story.asks else story.action
    there.set_title(f"As taught: {story.title}, {says}", fontsize=13, fontweight="bold", color=INK)
    below = f"{fill(taught(story), 72)}\n{fill(used(story), 72)}"
    there.text(0.5, -0.015, below, transform=there.transAxes, ha="center", va="top", fontsize=9, color=INK)
    moving = f"wheels: {granted.left_m_s:+.2f} / {granted.right_m_s:+.2f} m/s"
    if facts.reasons and not facts.latched:
        moving += f", on the way to {decided.left_m_s:+.2f} / {decided.right_m_s:+.2f}"
    here.text(0.5, -0.015, moving, transform=here.transAxes, ha="center", va="top", fontsize=9, color=INK)


def _mark(tip: Tip, colours: Mapping[str, str]) -> Mark:
    if tip.rla is None:
        return Mark(tip.sensor, tip.needed_m, "asks", ASKS)
    return Mark(tip.sensor, tip.needed_m, tip.rla.action, colours[tip.rla.action])


def _halves(
    names: tuple[str, ...], vector: tuple[float, ...], sensors: tuple[str, ...]
) -> tuple[dict[str, float], dict[str, float]]:
    """Readings of each sensor, and their averages, as far as they are features."""
    value = dict(zip(names, vector, strict=True))
    return (
        {name: value[name] for name in sensors if name in value},
        {name: value[name + AVERAGED] for name in sensors if name + AVERAGED in value},
    )


def _nearness(axes: Axes, level: LevelFacts, story: RlaStory | None, colours: Mapping[str, str]) -> None:
    """All RLAs on one line: the nearer the farther left."""
    _bare(axes)
    if level.nearest is None or story is None or not math.isfinite(level.nearest.distance):
        axes.set_axis_off()
        return
    radius = level.nearest.radius
    stories = [level.nearest, *level.others]
    end = 1.12 * max(radius, story.distance)
    axes.set_xlim(-0.01 * end, end)
    axes.set_ylim(-1.0, 1.0)
    axes.axvspan(0, radius, ymin=0.28, ymax=0.72, facecolor=_KNOWN, zorder=0)
    axes.plot([radius, radius], [-0.75, 0.75], color="#3f9b5c", linewidth=1.6, linestyle=(0, (4, 2)))
    axes.text(radius + 0.006 * end, 0.5, f"R {far(radius)}", color="#2b7a45", fontsize=9.5, ha="left", va="bottom")
    for each in reversed(stories):
        if each.distance <= end:
            axes.plot(each.distance, 0, "o", markersize=7, color=_dot(each, colours), markeredgecolor="white", zorder=3)
    axes.plot(story.distance, 0, "o", markersize=15, color=_dot(story, colours), markeredgecolor=INK, zorder=5)
    name, marks = f"{story.title}: {far(story.distance)}", [(story, 0.42)]
    axes.text(story.distance, 0.42, name, fontsize=10, fontweight="bold", ha=_side(story, end), va="bottom", color=INK)
    for other, word in ((level.runner_up, "runner-up"), (level.otherwise, "nearest that says something else")):
        if other is None or other is story or any(other is one for one, _ in marks) or other.distance > end:
            continue
        low = -0.42 - 0.5 * (len(marks) - 1)
        marks.append((other, low))
        if other is level.runner_up and other is level.otherwise:
            word = "runner-up"
        axes.plot(other.distance, 0, "o", markersize=10, color=_dot(other, colours), markeredgecolor=INK, zorder=4)
        axes.plot([other.distance, other.distance], [-0.1, low], color=PALE_INK, linewidth=0.8, zorder=2)
        axes.text(
            other.distance + 0.008 * end,
            low,
            f"{word}: {other.title}, {other.action}, {far(other.distance)}",
            fontsize=9,
            ha="left" if other.distance < 0.6 * end else "right",
            va="top",
            color=INK,
        )
    axes.text(0.0, 1.0, "how near each RLA is", fontsize=9.5, color=PALE_INK, ha="left", va="bottom")


def _side(story: RlaStory, end: float) -> str:
    return "left" if story.distance < 0.15 * end else "right" if story.distance > 0.85 * end else "center"


def _dot(story: RlaStory, colours: Mapping[str, str]) -> str:
    return ASKS if story.asks else colours.get(story.action, STANDS)


def _differences(axes: Axes, level: LevelFacts, story: RlaStory | None, rows: int) -> None:
    """The features that made the distance what it is: their shares, and both values."""
    _bare(axes)
    found = () if story is None else shares(level, story)[:rows]
    if story is None or not found:
        axes.set_axis_off()
        return
    axes.set_title(f"What makes the distance to {story.title}", fontsize=11.5, loc="left", color=INK, pad=12)
    highest = max(share.share for share in found)
    for row, share in enumerate(found):
        axes.barh(row, share.share, height=0.56, color=DIFFERS if row == 0 else "#f0b27f", zorder=2)
        axes.text(-0.03 * highest, row - 0.12, share.name, ha="right", va="center", fontsize=9.5, color=INK)
        axes.text(
            -0.03 * highest,
            row + 0.26,
            f"{number(share.here)} now, {number(share.there)} taught",
            ha="right",
            va="center",
            fontsize=8,
            color=PALE_INK,
        )
        axes.text(
            share.share + 0.015 * highest,
            row,
            f"{100 * share.share:.0f} %",
            ha="left",
            va="center",
            fontsize=9.5,
            color=INK,
        )
    axes.set_xlim(-0.95 * highest, 1.2 * highest)
    axes.set_ylim(rows - 0.4, -0.6)


def _tug_of_war(axes: Axes, level: LevelFacts, story: RlaStory | None, colours: Mapping[str, str], rows: int) -> None:
    """Which features speak for the one, which for the other."""
    _bare(axes)
    other = level.otherwise or level.runner_up
    if story is not None and other is not None and other.rla_id == story.rla_id:
        other = level.runner_up
    found = () if story is None or other is None else pulls(level, story, other)[:rows]
    if story is None or other is None or not found:
        axes.set_axis_off()
        return
    axes.set_title(
        f"Why not {other.title}, {'asks again' if other.asks else other.action}",
        fontsize=11.5,
        loc="left",
        color=INK,
        pad=12,
    )
    widest = max(abs(pull.pull) for pull in found)
    for row, pull in enumerate(found):
        mine = pull.pull > 0
        axes.barh(row, pull.pull, height=0.56, color=_dot(story if mine else other, colours), zorder=2)
        axes.text(-2.15 * widest, row - 0.12, pull.name, ha="left", va="center", fontsize=9.5, color=INK)
        axes.text(
            -2.15 * widest,
            row + 0.26,
            f"{number(pull.here)} now, {number(pull.in_first)} or {number(pull.in_second)}",
            ha="left",
            va="center",
            fontsize=8,
            color=PALE_INK,
        )
    axes.plot([0, 0], [-0.45, len(found) - 0.55], color=INK, linewidth=0.9, zorder=3)
    below = len(found) - 0.45
    axes.text(0.05 * widest, below, f"for {story.rla_id}", ha="left", va="top", fontsize=9, color=INK)
    axes.text(-0.05 * widest, below, f"for {other.rla_id}", ha="right", va="top", fontsize=9, color=INK)
    axes.set_xlim(-2.2 * widest, 1.1 * widest)
    axes.set_ylim(rows - 0.4, -0.6)


def _bare(axes: Axes) -> None:
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_visible(False)
