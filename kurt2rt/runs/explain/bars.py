"""Charts of an explanation: distances of the RLAs, and feature shares."""

import math
from collections.abc import Mapping

from matplotlib.axes import Axes

from kurt2rt.core.perception.sensor_words import SensorWords
from kurt2rt.runs.explain.attribution import distance_attribution
from kurt2rt.runs.explain.colours import ASKS, INK, PALE_INK, STANDS
from kurt2rt.runs.explain.facts import LevelFacts, RlaFacts
from kurt2rt.runs.explain.sensor_view import DIFFERS
from kurt2rt.runs.explain.sentences import format_distance, format_rla

_KNOWN, _LIMIT = "#e3f1e6", "#3f9b5c"


def draw_nearness(axes: Axes, level: LevelFacts, rla: RlaFacts | None, colours: Mapping[str, str]) -> None:
    """Draw all RLAs of a level on one line, nearer ones further left; `rla` is marked.

    `colours`: by action.
    """
    axes.set_yticks([])
    nearest = level.nearest
    if nearest is None or rla is None or not math.isfinite(nearest.distance):
        axes.set_axis_off()
        return
    end = 1.12 * max(nearest.radius, rla.distance)
    axes.set_xlim(-0.01 * end, end)
    axes.set_ylim(-2.0, 1.0)
    axes.axvspan(0, nearest.radius, facecolor=_KNOWN, zorder=0)
    axes.axvline(nearest.radius, color=_LIMIT, linestyle=(0, (4, 2)))
    axes.set_xticks([0, nearest.radius], ["0", f"R {format_distance(nearest.radius)}"])
    axes.set_title("how near each RLA is", fontsize=9.5, color=PALE_INK, loc="left")
    for each in (*reversed(level.others), nearest, rla):
        colour = ASKS if each.asks else colours.get(each.action, STANDS)
        edge, size = (INK, 14) if each is rla else ("white", 7)
        axes.plot(each.distance, 0, "o", markersize=size, color=colour, markeredgecolor=edge)
    named = {each.name: each for each in (rla, nearest, level.runner_up, level.otherwise) if each is not None}
    for row, each in enumerate(named.values()):
        axes.annotate(
            f"{format_rla(each)}: {format_distance(each.distance)}",
            (each.distance, 0),
            xytext=(4, 9 if row == 0 else -6 - 12 * row),
            textcoords="offset points",
            fontsize=9,
            fontweight="bold" if row == 0 else "normal",
            ha="left" if each.distance < 0.7 * end else "right",
            color=INK,
        )


def draw_differences(axes: Axes, level: LevelFacts, rla: RlaFacts | None, rows: int, words: SensorWords) -> None:
    """Draw the `rows` features with the largest shares of the distance to an RLA, and both values of each."""
    found = () if rla is None else distance_attribution(level, rla)[:rows]
    if rla is None or not found:
        axes.set_axis_off()
        return
    axes.set_title(f"What makes the distance to {rla.title}", fontsize=11.5, loc="right", color=INK, pad=12)
    names = [
        f"{words.place(each.name)}\n{words.reading(each.name, each.here)} now, "
        f"{words.reading(each.name, each.there)} taught"
        for each in found
    ]
    bars = axes.barh(names, [each.share for each in found], height=0.56, color=DIFFERS)
    axes.bar_label(bars, [f"{100 * each.share:.0f} %" for each in found], fontsize=9.5, padding=4)
    axes.invert_yaxis()
    axes.set_xticks([])
    axes.tick_params(length=0, labelsize=8.5)
    axes.spines[:].set_visible(False)
