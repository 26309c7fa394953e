"""Picture of a soak: memory, activity, lateness and faults over the hours."""

from collections.abc import Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from kurt2rt.checks.faults.table import TARGETS
from kurt2rt.checks.soak.checks import HOUR_S, memory_base_mb
from kurt2rt.checks.soak.result import SoakMinute, SoakResult
from kurt2rt.checks.soak.settings import LimitSettings

_BLUE, _ORANGE, _GREY, _RED, _GREEN = "#2b6cb0", "#dd8a1d", "#b8b8b8", "#c53030", "#2f855a"
_MOODS = ("#edf2f7", "#fefcbf", "#fed7d7", "#e9d8fd", "#c6f6d5", "#bee3f8", "#feebc8", "#cbd5e0")


def draw_soak(result: SoakResult, limits: LimitSettings, path: Path) -> None:
    """Draw memory, drives and faults of a soak against time, with its limits, and write a PNG. Raises OSError."""
    figure = Figure(figsize=(13.0, 11.0), layout="constrained")
    memory, robot, late, faults = figure.subplots(4, 1, sharex=True, height_ratios=(3, 3, 1.6, 3.4))
    hours = [each.at_s / HOUR_S for each in result.minutes]
    _draw_memory(memory, hours, result.minutes, limits)
    _draw_robot(robot, hours, result.minutes)
    _draw_lateness(late, hours, result.minutes)
    _draw_faults(faults, result)
    verdict = "everything held" if result.passed else "NOT everything held"
    figure.suptitle(
        f"{result.simulated_s / HOUR_S:.1f} h, seed {result.seed}: {len(result.faults)} faults, "
        f"{len(result.starts)} starts of the program, {result.ticks} ticks; {verdict}"
    )
    faults.set_xlabel("hours of simulated time")
    faults.set_xlim(0.0, max(result.simulated_s / HOUR_S, 1e-3))
    figure.savefig(path, dpi=110)


def _draw_memory(axes: Axes, hours: Sequence[float], minutes: Sequence[SoakMinute], limits: LimitSettings) -> None:
    axes.plot(hours, [each.resident_mb for each in minutes], color=_BLUE, linewidth=1.2)
    base_mb = memory_base_mb(minutes)
    if base_mb is not None:
        axes.axhline(base_mb + limits.memory_mb, color=_RED, linewidth=1.0, linestyle="--")
        axes.axhline(base_mb, color=_GREY, linewidth=1.0)
        axes.annotate(
            f"end of the first hour + {limits.memory_mb:g} MB",
            (1.0, base_mb + limits.memory_mb),
            xytext=(4, 3),
            textcoords="offset points",
            color=_RED,
            fontsize=8,
        )
    axes.set_ylabel("memory, MB", color=_BLUE)
    lessons = axes.twinx()
    lessons.plot(hours, [each.lessons for each in minutes], color=_ORANGE, linewidth=1.2)
    lessons.plot(hours, [each.rlas for each in minutes], color=_GREEN, linewidth=1.2)
    lessons.set_ylim(bottom=0)
    lessons.set_ylabel("lessons (orange), RLAs (green)")


def _draw_robot(axes: Axes, hours: Sequence[float], minutes: Sequence[SoakMinute]) -> None:
    moods = list(dict.fromkeys(each.mood for each in minutes))
    drives, asks = [each.drives for each in minutes], [each.asks for each in minutes]
    rest = [max(0.0, 1.0 - drive - ask) for drive, ask in zip(drives, asks, strict=True)]
    axes.stackplot(
        hours, drives, asks, rest, colors=(_BLUE, _ORANGE, _GREY), labels=("drives", "asks", "stands"), step="pre"
    )
    width = 1.0 / 60.0
    for at, mood in enumerate(moods):
        spans = [(hour - width, width) for hour, each in zip(hours, minutes, strict=True) if each.mood == mood]
        axes.broken_barh(spans, (1.01, 0.1), facecolors=_MOODS[at % len(_MOODS)], edgecolor="none", label=mood)
    axes.set_ylim(0.0, 1.12)
    axes.set_ylabel("share of each minute")
    axes.legend(loc="center left", bbox_to_anchor=(1.005, 0.5), fontsize=8, title="robot, teacher's mood (top)")


def _draw_lateness(axes: Axes, hours: Sequence[float], minutes: Sequence[SoakMinute]) -> None:
    axes.vlines(hours, 0.0, [each.missed_ticks for each in minutes], color=_RED, linewidth=0.8)
    axes.set_ylabel("missed ticks\nper minute", color=_RED)
    late = axes.twinx()
    late.plot(hours, [each.worst_late_s * 1000 for each in minutes], ".", color=_BLUE, markersize=2.5)
    late.set_ylabel("latest tick, ms", color=_BLUE)


def _draw_faults(axes: Axes, result: SoakResult) -> None:
    rows = {target: row for row, target in enumerate(reversed(TARGETS))}
    for label, colour, marker, chosen in (
        ("while it stood", _GREY, "|", [each for each in result.faults if not each.drove]),
        ("drove on", _BLUE, "|", [each for each in result.faults if each.drove and each.stood_after_s is None]),
        ("stood", _ORANGE, "|", [each for each in result.faults if each.drove and each.stood_after_s is not None]),
        ("not as it must", _RED, "x", [each for each in result.faults if each.complaints]),
    ):
        axes.plot(
            [each.at_s / HOUR_S for each in chosen],
            [rows[each.target] for each in chosen],
            marker,
            color=colour,
            markersize=9,
            label=f"{label}: {len(chosen)}",
        )
    for number, start in enumerate(result.starts):
        axes.axvline(
            start.at_s / HOUR_S, color="k", linewidth=0.4, alpha=0.5, label="program started" if number == 0 else None
        )
    axes.set_yticks(list(rows.values()), [target.replace("_", " ") for target in rows])
    axes.set_ylim(-0.7, len(rows) - 0.3)
    axes.legend(loc="center left", bbox_to_anchor=(1.005, 0.5), fontsize=8, title="faults")
