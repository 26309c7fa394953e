"""Bar charts of an explanation: distances of the RLAs, feature shares and feature contrast."""

import math
from collections.abc import Mapping

from matplotlib.axes import Axes

from kurt2rt.core.perception.sensor_words import SensorWords
from kurt2rt.runs.explain.attribution import contrast_attribution, distance_attribution
from kurt2rt.runs.explain.colours import ASKS, INK, PALE_INK, STANDS
from kurt2rt.runs.explain.facts import LevelFacts, RlaFacts
from kurt2rt.runs.explain.sensor_view import DIFFERS
from kurt2rt.runs.explain.sentences import format_distance

_KNOWN, _LIMIT, _LIMIT_INK = "#e3f1e6", "#3f9b5c", "#2b7a45"
_SMALLER = "#f0b27f"


def draw_nearness(axes: Axes, level: LevelFacts, rla: RlaFacts | None, colours: Mapping[str, str]) -> None:
    """Draw all RLAs of a level on one line, nearer ones further left; `rla` is marked.

    `colours`: by action.
    """
    _bare(axes)
    if level.nearest is None or rla is None or not math.isfinite(level.nearest.distance):
        axes.set_axis_off()
        return
    radius = level.nearest.radius
    rlas = [level.nearest, *level.others]
    end = 1.12 * max(radius, rla.distance)
    axes.set_xlim(-0.01 * end, end)
    axes.set_ylim(-1.0, 1.0)
    axes.axvspan(0, radius, ymin=0.28, ymax=0.72, facecolor=_KNOWN, zorder=0)
    axes.plot([radius, radius], [-0.75, 0.75], color=_LIMIT, linewidth=1.6, linestyle=(0, (4, 2)))
    axes.text(
        radius + 0.006 * end,
        0.5,
        f"R {format_distance(radius)}",
        color=_LIMIT_INK,
        fontsize=9.5,
        ha="left",
        va="bottom",
    )
    for each in reversed(rlas):
        if each.distance <= end:
            axes.plot(each.distance, 0, "o", markersize=7, color=_dot(each, colours), markeredgecolor="white", zorder=3)
    axes.plot(rla.distance, 0, "o", markersize=15, color=_dot(rla, colours), markeredgecolor=INK, zorder=5)
    name, marks = f"{rla.title}: {format_distance(rla.distance)}", [(rla, 0.42)]
    axes.text(rla.distance, 0.42, name, fontsize=10, fontweight="bold", ha=_side(rla, end), va="bottom", color=INK)
    named = [(level.runner_up, "runner-up"), (level.otherwise, "nearest that says something else")]
    if level.nearest.rla_id != rla.rla_id:
        named = [(level.nearest, "nearest")]
    for other, word in named:
        if other is None or other is rla or any(other is one for one, _ in marks) or other.distance > end:
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
            f"{word}: {other.title}, {other.action}, {format_distance(other.distance)}",
            fontsize=9,
            ha="left" if other.distance < 0.6 * end else "right",
            va="top",
            color=INK,
        )
    axes.text(0.0, 1.0, "how near each RLA is", fontsize=9.5, color=PALE_INK, ha="left", va="bottom")


def draw_differences(axes: Axes, level: LevelFacts, rla: RlaFacts | None, rows: int, words: SensorWords) -> None:
    """Draw the `rows` features with the largest shares of the distance to an RLA, and both values of each."""
    _bare(axes)
    found = () if rla is None else distance_attribution(level, rla)[:rows]
    if rla is None or not found:
        axes.set_axis_off()
        return
    axes.set_title(f"What makes the distance to {rla.title}", fontsize=11.5, loc="left", color=INK, pad=12)
    highest = max(share.share for share in found)
    for row, share in enumerate(found):
        axes.barh(row, share.share, height=0.56, color=DIFFERS if row == 0 else _SMALLER, zorder=2)
        _name_row(
            axes,
            -0.03 * highest,
            row,
            words.place(share.name),
            f"{words.reading(share.name, share.here)} now, {words.reading(share.name, share.there)} taught",
            ha="right",
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


def draw_contrast(
    axes: Axes, level: LevelFacts, rla: RlaFacts | None, colours: Mapping[str, str], rows: int, words: SensorWords
) -> None:
    """Draw the `rows` features that favour the RLA and those that favour its rival. `colours`: by action."""
    _bare(axes)
    other = None if rla is None else level.contrast_of(rla)
    found = () if rla is None or other is None else contrast_attribution(level, rla, other)[:rows]
    if rla is None or other is None or not found:
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
        axes.barh(row, pull.pull, height=0.56, color=_dot(rla if mine else other, colours), zorder=2)
        here, first, second = (words.reading(pull.name, each) for each in (pull.here, pull.in_first, pull.in_second))
        _name_row(axes, -2.15 * widest, row, words.place(pull.name), f"{here} now, {first} or {second}", ha="left")
    axes.plot([0, 0], [-0.45, len(found) - 0.55], color=INK, linewidth=0.9, zorder=3)
    below = len(found) - 0.45
    axes.text(0.05 * widest, below, f"for {rla.rla_id}", ha="left", va="top", fontsize=9, color=INK)
    axes.text(-0.05 * widest, below, f"for {other.rla_id}", ha="right", va="top", fontsize=9, color=INK)
    axes.set_xlim(-2.2 * widest, 1.1 * widest)
    axes.set_ylim(rows - 0.4, -0.6)


def _side(rla: RlaFacts, end: float) -> str:
    return "left" if rla.distance < 0.15 * end else "right" if rla.distance > 0.7 * end else "center"


def _dot(rla: RlaFacts, colours: Mapping[str, str]) -> str:
    return ASKS if rla.asks else colours.get(rla.action, STANDS)


def _name_row(axes: Axes, x: float, row: int, name: str, values: str, *, ha: str) -> None:
    """Write a feature's name next to its bar, and its values below."""
    axes.text(x, row - 0.12, name, ha=ha, va="center", fontsize=9.5, color=INK)
    axes.text(x, row + 0.26, values, ha=ha, va="center", fontsize=8, color=PALE_INK)


def _bare(axes: Axes) -> None:
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_visible(False)
