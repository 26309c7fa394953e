"""Drawing of worlds on the caller's axes."""

import math
from typing import TYPE_CHECKING

from simbridge.worlds.world_settings import WorldSettings

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_WALL = "#c3c9cf"
_WALL_EDGE = "#3d454d"
_TEXT = "#222222"
_TEXT_SIZE = 11.0
_MARGIN_M = 0.15
_MOST_TICKS = 10


def draw_world(axes: "Axes", world: WorldSettings) -> None:
    """Draw walls and obstacles to scale in metres, seen from above."""
    # Imported here: driving a simulated robot needs no matplotlib.
    from matplotlib.patches import Circle, Polygon

    width_m, height_m = world.size_m
    axes.set_xlim(-_MARGIN_M, width_m + _MARGIN_M)
    axes.set_ylim(-_MARGIN_M, height_m + _MARGIN_M)
    axes.set_aspect("equal")
    axes.set_facecolor(_WALL)
    outline = axes.add_patch(
        Polygon(world.outline, closed=True, facecolor="white", edgecolor=_WALL_EDGE, linewidth=2.0, zorder=0)
    )
    for corners in world.solids:
        solid = axes.add_patch(
            Polygon(corners, closed=True, facecolor=_WALL, edgecolor=_WALL_EDGE, linewidth=1.5, zorder=1)
        )
        solid.set_clip_path(outline)  # many walls start inside the wall they lean on
    for post in world.round_obstacles:
        axes.add_patch(
            Circle((post.x_m, post.y_m), post.radius_m, facecolor=_WALL, edgecolor=_WALL_EDGE, linewidth=1.5, zorder=1)
        )
    step_m = next(step_m for step_m in (1, 2, 5, 10, 20, 50) if max(width_m, height_m) <= _MOST_TICKS * step_m)
    axes.set_xticks(range(0, math.floor(width_m) + 1, step_m))
    axes.set_yticks(range(0, math.floor(height_m) + 1, step_m))
    axes.tick_params(length=0, labelsize=_TEXT_SIZE, colors=_TEXT)
    for spine in axes.spines.values():
        spine.set_visible(False)
    axes.set_xlabel("x in m", fontsize=_TEXT_SIZE, color=_TEXT)
    axes.set_ylabel("y in m", fontsize=_TEXT_SIZE, color=_TEXT)
