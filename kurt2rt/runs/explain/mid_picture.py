"""Picture of the mid level's situation: a map of known places, or the last symbols here and as taught."""

from collections.abc import Mapping, Sequence

from matplotlib.axes import Axes
from matplotlib.patches import Circle, FancyBboxPatch

from kurt2rt.runs.explain.colours import ASKS, INK, PALE_INK, STANDS
from kurt2rt.runs.explain.facts import LevelFacts, RlaFacts
from kurt2rt.runs.explain.sentences import format_distance

_KNOWN, _LIMIT = "#e3f1e6", "#3f9b5c"
_SAME, _OTHER = "#dfe5ea", "#f0b27f"
_ARROW_M = 0.42
_ROOM_M = 0.6
_MOST_SYMBOLS = 12


def draw_mid(axes: Axes, mid: LevelFacts, colours: Mapping[str, str]) -> None:
    """Draw a map or a row of symbols, depending on the situation's features. `colours`: by action."""
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_visible(False)
    if mid.names[:4] == ("x_m", "y_m", "east", "north"):
        _draw_places(axes, mid, colours)
    else:
        _draw_symbols(axes, mid)


def _draw_places(axes: Axes, mid: LevelFacts, colours: Mapping[str, str]) -> None:
    """Draw each place with its heading of arrival, in the colour of its action."""
    rlas = [rla for rla in (mid.nearest, *mid.others) if rla is not None]
    x_m, y_m, east, north = mid.vector[:4]
    lost = mid.lost
    title = "The places it knows" if lost else "Where it is, and the places it knows"
    axes.set_title(title, fontsize=11.5, loc="left", color=INK, pad=8)
    axes.set_aspect("equal", adjustable="datalim")
    if not lost and rlas:
        axes.add_patch(
            Circle((x_m, y_m), rlas[0].radius, facecolor=_KNOWN, edgecolor=_LIMIT, linestyle=(0, (4, 2)), zorder=1)
        )
    for rla in rlas:
        x, y, dx, dy = rla.condition[:4]
        colour = ASKS if rla.asks else colours.get(rla.action, STANDS)
        chosen = mid.driver is not None and rla.rla_id == mid.driver.rla_id
        _arrow(axes, (x, y), (dx, dy), colour, wide=3.6 if chosen else 2.2)
        axes.plot(x, y, "o", markersize=8 if chosen else 5, color=colour, markeredgecolor=INK if chosen else "white")
        axes.annotate(str(rla.rla_id), (x, y), xytext=(4, 5), textcoords="offset points", fontsize=7.5, color=PALE_INK)
    if not lost:
        _arrow(axes, (x_m, y_m), (east, north), INK, wide=2.6)
        axes.plot(x_m, y_m, "*", markersize=15, color=INK, markeredgecolor="white", zorder=9)
    shown = [(x, y) for x, y, *_ in [rla.condition for rla in rlas]] + ([] if lost else [(x_m, y_m)])
    if shown:
        low_x, high_x = min(x for x, _ in shown), max(x for x, _ in shown)
        low_y, high_y = min(y for _, y in shown), max(y for _, y in shown)
        axes.update_datalim([(low_x - _ROOM_M, low_y - _ROOM_M), (high_x + _ROOM_M, high_y + _ROOM_M)])
        axes.autoscale_view()
    if mid.nearest is not None and not lost:
        distance, radius = format_distance(mid.nearest.distance), format_distance(mid.nearest.radius)
        text = f"star: here; nearest {mid.nearest.title} at {distance} m, R {radius} m"
        axes.set_xlabel(text, fontsize=9, color=PALE_INK)
    if lost:
        axes.set_xlabel("it is lost: no teacher has set its location", fontsize=9, color=ASKS)


def _arrow(axes: Axes, at: tuple[float, float], along: tuple[float, float], colour: str, *, wide: float) -> None:
    end = (at[0] + _ARROW_M * along[0], at[1] + _ARROW_M * along[1])
    axes.annotate("", end, at, arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": wide}, zorder=6)


def _draw_symbols(axes: Axes, mid: LevelFacts) -> None:
    """Draw two rows of symbols, newest on the left: the situation and the nearest condition."""
    nearest = mid.nearest
    axes.set_title("What came last, the newest first", fontsize=11.5, loc="left", color=INK, pad=8)
    count = min(len(mid.vector), _MOST_SYMBOLS)
    axes.set_xlim(-0.1, count + 0.1)
    axes.set_ylim(-1.5, 1.9)
    _row(axes, 1.0, mid.words, mid.vector, nearest, count)
    if nearest is not None:
        _row(axes, -0.4, mid.nearest_words, nearest.condition, None, count, mid.vector)
        axes.text(0, -0.75, f"as {nearest.title} knows it", fontsize=8.5, color=PALE_INK, va="top")
        differ = sum(here != there for here, there in zip(mid.vector, nearest.condition, strict=True))
        axes.text(
            count,
            -0.75,
            f"{differ} places differ, R {format_distance(nearest.radius)}",
            fontsize=8.5,
            color=PALE_INK,
            va="top",
            ha="right",
        )
    axes.text(0, 1.75, "here", fontsize=8.5, color=PALE_INK, va="bottom")


def _row(
    axes: Axes,
    height: float,
    words: Sequence[str],
    values: Sequence[float],
    nearest: RlaFacts | None,
    count: int,
    other: Sequence[float] | None = None,
) -> None:
    compared = nearest.condition if nearest is not None else other
    for place in range(count):
        differs = compared is not None and values[place] != compared[place]
        axes.add_patch(
            FancyBboxPatch(
                (place + 0.06, height - 0.3),
                0.88,
                0.6,
                boxstyle="round,pad=0,rounding_size=0.1",
                facecolor=_OTHER if differs else _SAME,
                edgecolor="none",
            )
        )
        word = words[place] if place < len(words) else ""
        size = 6.8 if len(word) < 7 else 5.4
        axes.text(place + 0.5, height, word[:10], ha="center", va="center", fontsize=size, color=INK)
