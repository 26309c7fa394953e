"""Top view of the robot with the readings of its sensors, front up."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.patches import Polygon, Rectangle

from hal.robot import WheelSpeeds
from hal.robot_settings import InfraredSettings, RobotSettings, SensorSettings
from kurt2rt.runs.explain.colours import INK

DIFFERS = "#d9480f"
"""Sensors with the largest shares of the distance."""
_BEAM, _NOTHING = "#a9c7de", "#edf1f4"
_WALL = "#39424c"
_AVERAGE = "#7a4fa3"
_BODY = "#f7c948"
_HALF_BEAM_RAD = 0.085
_MARGIN_M = 0.10
_MOTION_S, _MOTION_STEPS = 1.6, 16
_ARROW_S = 1.0
"""Time span of the arrows of the wheels."""

LEGEND = (
    "fans: what each sensor sees, as far as a wall (bold); orange: where the two differ most; "
    "diamonds: the average of the last seconds; arrows: the wheels"
)

Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class SensorView:
    """Readings and motion to draw in the top view of the robot; any sensor may be absent."""

    counts: Mapping[str, float]
    averages: Mapping[str, float]
    """Readings averaged over the last seconds."""
    differing: Collection[str] = ()
    """Sensors to highlight."""
    motion: WheelSpeeds | None = None
    """Set points to draw as arrows."""
    colour: str = INK
    """Colour of the arrows."""


def draw_sensor_view(axes: Axes, robot: RobotSettings, view: SensorView, wall_width: float = 3.2) -> None:
    """Draw one situation from above, in m: body, beams, readings and wheel speeds.

    `wall_width`: of the lines where a sensor sees something, in points.
    """
    law = robot.infrared
    length_m, width_m = robot.geometry.outline_length_m, robot.geometry.outline_width_m
    reach_m = law.far_m + _MARGIN_M
    axes.set_xlim(-width_m / 2 - reach_m, width_m / 2 + reach_m)
    axes.set_ylim(-length_m / 2 - reach_m, length_m / 2 + reach_m)
    axes.set_aspect("equal")
    axes.set_axis_off()
    for sensor in law.sensors:
        if sensor.name in view.counts:
            _sensor(axes, law, sensor, view, wall_width)
    axes.add_patch(
        Rectangle((-width_m / 2, -length_m / 2), width_m, length_m, facecolor=_BODY, edgecolor=INK, zorder=4)
    )
    nose = [(0.0, length_m * 0.43), (-width_m * 0.13, length_m * 0.31), (width_m * 0.13, length_m * 0.31)]
    axes.add_patch(Polygon(nose, closed=True, facecolor=INK, edgecolor="none", zorder=5))
    if view.motion is not None:
        for x_m, speed_m_s in zip((-width_m / 2, width_m / 2), view.motion, strict=True):
            arrow = {"arrowstyle": "-|>", "color": view.colour, "linewidth": 4}
            if speed_m_s:
                axes.annotate("", (x_m, speed_m_s * _ARROW_S), (x_m, 0.0), arrowprops=arrow, zorder=8)


def draw_motion(axes: Axes, robot: RobotSettings, wheels: WheelSpeeds, colour: str) -> None:
    """Draw the way of the robot's nose by fixed set points, as an arrow; of a robot that stands, a square."""
    if not any(wheels):
        axes.plot(0.0, 0.0, "s", markersize=6, color=colour, zorder=8)
        return
    nose_m, speed_m_s = robot.geometry.outline_length_m / 2, (wheels.left_m_s + wheels.right_m_s) / 2
    turn_rad_s = (wheels.right_m_s - wheels.left_m_s) / robot.geometry.effective_track_m
    ahead_m = left_m = 0.0
    way = []
    for step in range(_MOTION_STEPS + 1):
        heading_rad = turn_rad_s * _MOTION_S * step / _MOTION_STEPS
        way.append((-left_m - nose_m * math.sin(heading_rad), ahead_m + nose_m * math.cos(heading_rad)))
        ahead_m += speed_m_s * math.cos(heading_rad) * _MOTION_S / _MOTION_STEPS
        left_m += speed_m_s * math.sin(heading_rad) * _MOTION_S / _MOTION_STEPS
    axes.plot(*zip(*way, strict=True), color=colour, linewidth=2.0, zorder=8)
    arrow = {"arrowstyle": "-|>", "color": colour, "linewidth": 2.0, "mutation_scale": 7, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", way[-1], way[-2], arrowprops=arrow, zorder=8)


def _sensor(axes: Axes, law: InfraredSettings, sensor: SensorSettings, view: SensorView, wall_width: float) -> None:
    """Draw the beam of a sensor, the wall that it sees, and its average."""
    counts, differs = view.counts[sensor.name], sensor.name in view.differing
    distance_m, sees = law.distance_m(counts), _is_detected(law, counts)
    edge = [_along(sensor, distance_m, part * _HALF_BEAM_RAD) for part in (-1.0, -0.5, 0.0, 0.5, 1.0)]
    colour = DIFFERS if differs else _BEAM if sees else _NOTHING
    fan = [_along(sensor, 0.0), *edge]
    axes.add_patch(Polygon(fan, facecolor=colour, edgecolor="none", alpha=0.55 if differs else 0.8, zorder=2))
    if sees:
        axes.plot(*zip(*edge, strict=True), color=_WALL, linewidth=wall_width, solid_capstyle="round", zorder=5)
    if differs:
        text = f"{distance_m * 100:.0f} cm" if sees else "nothing"
        place = _along(sensor, distance_m + 0.1 if sees else 0.75 * distance_m)
        axes.text(*place, text, ha="center", va="center", fontsize=9.5, fontweight="bold", color=DIFFERS, zorder=8)
    average = view.averages.get(sensor.name)
    if average is not None and _is_detected(law, average):
        place = _along(sensor, law.distance_m(average))
        axes.plot(*place, "D", markersize=4.5, color=_AVERAGE, fillstyle="none", zorder=7)


def _is_detected(law: InfraredSettings, counts: float) -> bool:
    """Return whether a reading stands out from the noise at the end of the sensor's range."""
    return counts > law.floor_counts + 4 * law.noise_least_counts


def _along(sensor: SensorSettings, distance_m: float, aside_rad: float = 0.0) -> Point:
    """Return the picture coordinates, ahead up, of a point on a sensor's ray."""
    heading_rad = math.radians(sensor.heading_deg) + aside_rad
    x_m, y_m = sensor.x_m + distance_m * math.cos(heading_rad), sensor.y_m + distance_m * math.sin(heading_rad)
    return -y_m, x_m
