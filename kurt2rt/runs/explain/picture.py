"""Picture of a decision: situation next to the taught condition, distances of the RLAs, feature shares."""

from collections.abc import Mapping
from pathlib import Path
from textwrap import fill

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hal.robot_settings import RobotSettings
from kurt2rt.core.decision.decision import ASKING, DecisionCause
from kurt2rt.core.perception.definition import AVERAGED
from kurt2rt.core.perception.sensor_words import words_for
from kurt2rt.platform.save_figure import save_figure
from kurt2rt.runs.explain.attribution import distance_attribution
from kurt2rt.runs.explain.bars import draw_differences, draw_nearness
from kurt2rt.runs.explain.colours import ASKS, INK, PALE_INK, STANDS, TEACHER, colours_of, ink_on
from kurt2rt.runs.explain.counterfactual import SensorCounterfactual
from kurt2rt.runs.explain.facts import DecisionFacts, RlaFacts
from kurt2rt.runs.explain.reasons import format_reasons, headline
from kurt2rt.runs.explain.sensor_view import LEGEND, SensorView, draw_sensor_view
from kurt2rt.runs.explain.sentences import (
    format_counterfactuals,
    format_mid_level,
    format_rla,
    format_teaching,
    format_usage,
)

_FEATURES = 12
_POINTED_AT = 4
_CAPTION = 76
"""Characters per line below a situation."""
_WORTH_POINTING = 0.03


def draw_why(
    facts: DecisionFacts, found: tuple[SensorCounterfactual, ...], robot: RobotSettings, title: str, path: Path
) -> None:
    """Write the picture of one decision in the format of the file's suffix. Raises OSError.

    `found`: changes of one reading that would have changed the decision.
    """
    level = facts.basic
    rla = level.driver or level.nearest
    known = (*([] if rla is None else [rla]), *level.others)
    colours = colours_of([each.action for each in known] + ([facts.action] if facts.action else []))
    figure = Figure(figsize=(14.5, 9.2), facecolor="white")
    top = _heading(figure, facts, found, title, colours)
    # Between the rows there is room for four lines about who taught it.
    rows = {"height_ratios": (1.0, 0.14), "hspace": 0.32}
    grid = figure.add_gridspec(2, 2, left=0.015, right=0.63, top=top, bottom=0.085, wspace=0.05, **rows)
    _situations(figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[0, 1]), facts, robot, rla, colours)
    draw_nearness(figure.add_subplot(grid[1, :]), level, rla, colours)
    draw_differences(
        figure.add_axes((0.83, 0.085, 0.12, top - 0.12)), *facts.deciding, _FEATURES, words_for(robot.infrared)
    )
    figure.text(0.02, 0.014, LEGEND, fontsize=8.5, color=PALE_INK)
    save_figure(figure, path)


def _heading(
    figure: Figure,
    facts: DecisionFacts,
    found: tuple[SensorCounterfactual, ...],
    title: str,
    colours: Mapping[str, str],
) -> float:
    """Write the decision in words and return the top of the remaining area, 0 to 1 of the figure."""
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
    changes = format_counterfactuals(found, most=1)
    lines = [
        *format_reasons(facts),
        *([f"It would have been otherwise with {changes[0]}."] if changes else []),
        *format_mid_level(facts)[:1],
    ]
    text = "\n".join(fill(line, 178) for line in lines)
    figure.text(0.02, 0.886, text, fontsize=10.5, color=INK, va="top", linespacing=1.4)
    return 0.83 - 0.023 * text.count("\n")


def _colour_of(facts: DecisionFacts, colours: Mapping[str, str]) -> str:
    if facts.action is not None and not facts.latched:
        return TEACHER if facts.cause == DecisionCause.TEACHER else colours[facts.action]
    return ASKS if facts.cause in ASKING and not facts.latched else STANDS


def _situations(
    here: Axes,
    there: Axes,
    facts: DecisionFacts,
    robot: RobotSettings,
    rla: RlaFacts | None,
    colours: Mapping[str, str],
) -> None:
    level, sensors = facts.basic, robot.infrared.names
    pointed_at: set[str] = set()
    if rla is not None:
        differing = [share.name for share in distance_attribution(level, rla) if share.share >= _WORTH_POINTING]
        pointed_at = set([name for name in differing if name in sensors][:_POINTED_AT])
    decided, granted = facts.decided, facts.granted
    motion = granted if facts.latched else decided
    counts, averages = _halves(level.names, level.vector, sensors)
    view = SensorView(counts, averages, pointed_at, motion, _colour_of(facts, colours))
    draw_sensor_view(here, robot, view)
    here.set_title(f"Now: tick {facts.tick}", fontsize=13, fontweight="bold", color=INK)
    if rla is None:
        there.set_axis_off()
        there.text(0.5, 0.5, "nothing was taught yet", ha="center", va="center", color=PALE_INK, fontsize=13)
        return
    counts, averages = _halves(level.names, rla.condition, sensors)
    draw_sensor_view(there, robot, SensorView(counts, averages, pointed_at))
    there.set_title(f"As taught: {format_rla(rla)}", fontsize=13, fontweight="bold", color=INK)
    below = f"{fill(format_teaching(rla), _CAPTION)}\n{fill(format_usage(rla), _CAPTION)}"
    there.text(0.5, -0.015, below, transform=there.transAxes, ha="center", va="top", fontsize=8.5, color=INK)
    moving = f"wheels: {granted.left_m_s:+.2f} / {granted.right_m_s:+.2f} m/s"
    if facts.reasons and not facts.latched:
        moving += f", on the way to {decided.left_m_s:+.2f} / {decided.right_m_s:+.2f}"
    here.text(0.5, -0.015, moving, transform=here.transAxes, ha="center", va="top", fontsize=9, color=INK)


def _halves(
    names: tuple[str, ...], vector: tuple[float, ...], sensors: tuple[str, ...]
) -> tuple[dict[str, float], dict[str, float]]:
    """Return the readings and the averages of the sensors that are features."""
    value = dict(zip(names, vector, strict=True))
    return (
        {name: value[name] for name in sensors if name in value},
        {name: value[name + AVERAGED] for name in sensors if name + AVERAGED in value},
    )
