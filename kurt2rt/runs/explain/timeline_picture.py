"""Picture of a run: path, activities, distance of the nearest RLA, and driving RLA."""

import math
from bisect import bisect_left
from collections.abc import Mapping, Sequence
from itertools import groupby, pairwise
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from kurt2rt.platform.drive_picture import END, START, draw_arrows, draw_marks, draw_robot
from kurt2rt.platform.save_figure import ShownFigure, save_figure
from kurt2rt.runs.explain.colours import ASKS, INK, PALE_INK, STANDS, TEACHER, colours_of
from kurt2rt.runs.explain.timeline import Kind, Sample, Stretch, Timeline, format_summary, kind_intervals

_KNOWN, _LIMIT = "#e3f1e6", "#3f9b5c"
_CURVE = "#3b4754"
_LEFT, _RIGHT, _HELD_BACK = "#2b7bba", "#c85a0a", "#efe3f5"
_HIGHEST_SHARE = 1.6
_ARROW_EVERY_M = 0.6
_MOST_NUMBERED = 24
_OF_KIND = {
    Kind.LED: (TEACHER, "led by a teacher"),
    Kind.ASKS: (ASKS, "stands and asks"),
    Kind.STANDS: (STANDS, "stands"),
}
"""Colours and labels of all kinds but driving by RLAs, which has those of its actions."""
_OF_NOTE = {"lesson": ("v", INK, 1.22), "alarm": ("X", ASKS, 1.5)}
"""Marker, colour and height of the notes that are drawn, by kind."""


def draw_timeline(timeline: Timeline, title: str, path: Path) -> None:
    """Write the picture in the format of the file's suffix. Raises OSError."""
    save_figure(timeline_figure(timeline, title), path)


def timeline_figure(timeline: Timeline, title: str) -> Figure:
    """Return the picture as a figure."""
    colours = colours_of(stretch.what for stretch in timeline.stretches if stretch.kind is Kind.DRIVES)
    figure = ShownFigure(figsize=(16.0, 8.6), facecolor="white")
    figure.text(0.02, 0.962, title, fontsize=15, fontweight="bold", color=INK, va="center")
    figure.text(0.02, 0.925, format_summary(timeline), fontsize=10.5, color=PALE_INK, va="center")
    grid = figure.add_gridspec(
        4,
        2,
        left=0.03,
        right=0.985,
        top=0.86,
        bottom=0.14,
        width_ratios=(0.62, 1.0),
        height_ratios=(0.34, 1.0, 1.0, 0.7),
        wspace=0.11,
        hspace=0.16,
    )
    _path(figure.add_subplot(grid[:, 0]), timeline, colours)
    lanes = [figure.add_subplot(grid[row, 1]) for row in range(4)]
    _stretch_lane(lanes[0], timeline, colours)
    _familiarity(lanes[1], timeline)
    _drivers(lanes[2], timeline, colours)
    _speeds(lanes[3], timeline)
    for lane in lanes:
        lane.set_xlim(timeline.from_s, max(timeline.to_s, timeline.from_s + 0.01))
        lane.tick_params(length=0, labelsize=9, colors=PALE_INK)
        for side in ("top", "right", "left", "bottom"):
            lane.spines[side].set_visible(False)
        if lane is not lanes[-1]:
            lane.set_xticks([])
    lanes[-1].set_xlabel("s into the run", fontsize=9.5, color=PALE_INK)
    _legend(figure, timeline, colours)
    return figure


def _colour_of(stretch: Stretch, colours: Mapping[str, str]) -> str:
    """Return the colour of the stretch's kind, or of its action."""
    return colours[stretch.what] if stretch.kind is Kind.DRIVES else _OF_KIND[stretch.kind][0]


def _path(axes: Axes, timeline: Timeline, colours: Mapping[str, str]) -> None:
    """Draw the dead-reckoned path in the colours of the activities."""
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_axis_off()
    samples = timeline.samples
    if not samples:
        return
    stretches = iter(timeline.stretches)
    stretch = next(stretches)
    lines: list[list[tuple[float, float]]] = []
    shades: list[str] = []
    for one, other in pairwise(samples):
        while one.at_s >= stretch.to_s:
            stretch = next(stretches, stretch)
            if stretch is timeline.stretches[-1]:
                break
        lines.append([(one.x_m, one.y_m), (other.x_m, other.y_m)])
        shades.append(_colour_of(stretch, colours))
    axes.add_collection(LineCollection(lines, colors=shades, linewidths=2.4, capstyle="round", zorder=3))
    first, last = samples[0], samples[-1]
    draw_arrows(axes, [(each.x_m, each.y_m) for each in samples], _ARROW_EVERY_M, INK)
    for end, colour, name in ((first, START, "begin"), (last, END, "end")):
        place = end.x_m, end.y_m
        draw_robot(axes, (*place, end.heading_rad), timeline.outline_m, colour)
        axes.annotate(name, place, xytext=(0, -34), textcoords="offset points", ha="center", fontsize=9, color=INK)
    asked = kind_intervals(timeline, Kind.ASKS)
    for number, (from_s, _) in enumerate(asked, start=1):
        asked_at = _at(samples, from_s)
        draw_marks(axes, [(asked_at.x_m, asked_at.y_m)], ())
        if len(asked) <= _MOST_NUMBERED:
            axes.annotate(
                str(number),
                (asked_at.x_m, asked_at.y_m),
                xytext=(5, 5),
                textcoords="offset points",
                fontsize=8.5,
                color=ASKS,
                zorder=7,
            )
    axes.autoscale_view()
    _scale(axes, samples)


def _scale(axes: Axes, samples: Sequence[Sample]) -> None:
    """Draw a scale bar of a round length."""
    low_x, low_y = min(each.x_m for each in samples), min(each.y_m for each in samples)
    wide_m = max(max(each.x_m for each in samples) - low_x, max(each.y_m for each in samples) - low_y, 0.2)
    length_m = max((each for each in (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 50.0) if each <= wide_m / 2), default=0.1)
    y = low_y - 0.09 * wide_m
    axes.plot([low_x, low_x + length_m], [y, y], color=INK, linewidth=2.0, solid_capstyle="butt")
    axes.text(low_x, y - 0.015 * wide_m, f"{length_m:g} m, by the encoders", fontsize=9, color=PALE_INK, va="top")


def _at(samples: Sequence[Sample], at_s: float) -> Sample:
    behind = bisect_left(samples, at_s, key=lambda sample: sample.at_s)
    return min(samples[max(behind - 1, 0) : behind + 1], key=lambda sample: abs(sample.at_s - at_s))


def _stretch_lane(axes: Axes, timeline: Timeline, colours: Mapping[str, str]) -> None:
    """Draw the activities over time, with lessons and alarms above."""
    spans = [(stretch.from_s, stretch.lasts_s) for stretch in timeline.stretches]
    shades = [_colour_of(stretch, colours) for stretch in timeline.stretches]
    axes.broken_barh(spans, (0.0, 1.0), facecolors=shades, linewidth=0)
    asked = kind_intervals(timeline, Kind.ASKS)
    if len(asked) <= _MOST_NUMBERED:
        for number, (from_s, to_s) in enumerate(asked, start=1):
            axes.text((from_s + to_s) / 2, -0.08, str(number), ha="center", va="top", fontsize=8, color=ASKS)
    for kind, (marker, colour, height) in _OF_NOTE.items():
        times = [note.at_s for note in timeline.notes if note.kind == kind]
        axes.plot(times, [height] * len(times), marker, markersize=6, color=colour, linestyle="none", clip_on=False)
    axes.set_ylim(-0.3, 1.75)
    axes.set_yticks([])
    axes.set_ylabel("what it did", fontsize=9.5, color=PALE_INK)


def _familiarity(axes: Axes, timeline: Timeline) -> None:
    """Draw the distance of the nearest RLA as a fraction of R."""
    times = [sample.at_s for sample in timeline.samples]
    shown = [min(sample.share, _HIGHEST_SHARE) for sample in timeline.samples]
    axes.axhspan(0, 1, facecolor=_KNOWN, zorder=0)
    axes.axhline(1, color=_LIMIT, linewidth=1.4, linestyle=(0, (4, 2)), zorder=1)
    axes.plot(times, shown, color=_CURVE, linewidth=0.9, zorder=3)
    above = [not math.isnan(share) and share > 1 for share in shown]
    axes.fill_between(times, 1, shown, where=above, color=ASKS, alpha=0.75, linewidth=0, zorder=2)
    highest = max((share for share in shown if not math.isnan(share)), default=1.0)
    axes.set_ylim(0, max(1.12, 1.06 * highest))
    axes.set_yticks([0, 0.5, 1], ["0", "0.5 R", "R"])
    axes.set_ylabel("nearest RLA", fontsize=9.5, color=PALE_INK)


def _drivers(axes: Axes, timeline: Timeline, colours: Mapping[str, str]) -> None:
    """Draw the id of the driving RLA over time."""
    highest = 1
    lines: list[list[tuple[float, float]]] = []
    shades: list[str] = []
    ends = [sample.at_s for sample in timeline.samples[1:]] + [timeline.to_s]
    spans = zip(timeline.samples, ends, strict=False)
    for (rla_id, action), group in groupby(spans, key=lambda span: (span[0].rla_id, span[0].action)):
        if rla_id is None or action is None:
            continue
        drives = list(group)
        highest = max(highest, rla_id)
        lines.append([(drives[0][0].at_s, rla_id), (drives[-1][1], rla_id)])
        shades.append(colours.get(action, STANDS))
    axes.add_collection(LineCollection(lines, colors=shades, linewidths=5.0, zorder=3))
    axes.set_ylim(0, highest * 1.06 + 0.5)
    axes.grid(axis="y", color="#e4e8ec", linewidth=0.8, zorder=0)
    axes.set_ylabel("RLA that drives", fontsize=9.5, color=PALE_INK)


def _speeds(axes: Axes, timeline: Timeline) -> None:
    """Draw the wheel set points, shaded where the guard reduced them."""
    times = [sample.at_s for sample in timeline.samples]
    left = [sample.left_m_s for sample in timeline.samples]
    right = [sample.right_m_s for sample in timeline.samples]
    low, high = min([0.0, *left, *right]) - 0.02, max([0.1, *left, *right]) + 0.02
    held_back = [sample.held_back for sample in timeline.samples]
    axes.fill_between(times, low, high, where=held_back, step="mid", color=_HELD_BACK, linewidth=0, zorder=0)
    axes.axhline(0, color="#e4e8ec", linewidth=0.8, zorder=1)
    axes.plot(times, left, color=_LEFT, linewidth=0.9, zorder=2)
    axes.plot(times, right, color=_RIGHT, linewidth=0.9, zorder=3)
    axes.set_ylim(low, high)
    axes.set_ylabel("wheels, m/s", fontsize=9.5, color=PALE_INK)


def _legend(figure: Figure, timeline: Timeline, colours: Mapping[str, str]) -> None:
    kinds = {stretch.kind for stretch in timeline.stretches}
    handles: list[Patch | Line2D] = [Patch(color=colour, label=action) for action, colour in colours.items()]
    handles += [Patch(color=colour, label=label) for kind, (colour, label) in _OF_KIND.items() if kind in kinds]
    for kind_of_note, (marker, colour, _) in _OF_NOTE.items():
        if any(note.kind == kind_of_note for note in timeline.notes):
            handles.append(Line2D([], [], marker=marker, linestyle="none", color=colour, label=kind_of_note))
    handles += [Line2D([], [], color=_LEFT, label="left wheels"), Line2D([], [], color=_RIGHT, label="right wheels")]
    if any(sample.held_back for sample in timeline.samples):
        handles.append(Patch(color=_HELD_BACK, label="held back by the guard"))
    figure.legend(handles=handles, loc="lower center", ncols=min(len(handles), 9), frameon=False, fontsize=9.5)
