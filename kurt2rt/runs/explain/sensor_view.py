"""Top view of the robot with the readings of its sensors, front up."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from matplotlib import patheffects
from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch, Polygon, Rectangle

from hal.robot import WheelSpeeds
from hal.robot_settings import InfraredSettings, RobotSettings, SensorSettings
from kurt2rt.runs.explain.colours import INK

DIFFERS = "#d9480f"
"""Sensors with the largest shares of the distance."""
_BEAM, _NOTHING = "#a9c7de", "#edf1f4"
_WALL = "#39424c"
_AVERAGE = "#7a4fa3"
_BODY, _WHEEL = "#f7c948", "#2b2f36"
_HALF_BEAM_RAD = 0.085
_MARGIN_M = 0.10
_ONE_WALL_M = 0.17
"""Largest gap between the ends of two readings on one side that are drawn as one wall."""
_ARROW_S = 1.4
"""Time span of the motion arrow."""

LEGEND = (
    "fans: what each sensor sees, as far as a wall (bold); orange: where the two differ most; "
    "diamonds: the average of the last seconds"
)

Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class SensorMark:
    """Mark on a sensor's ray in the top view: the reading at which the robot would decide otherwise."""

    sensor: str
    distance_m: float
    text: str
    colour: str


@dataclass(frozen=True, slots=True)
class SensorView:
    """Readings, marks and motion to draw in the top view of the robot; any sensor may be absent."""

    counts: Mapping[str, float]
    averages: Mapping[str, float]
    """Readings averaged over the last seconds."""
    differing: Collection[str] = ()
    """Sensors to highlight."""
    marks: Sequence[SensorMark] = ()
    motion: WheelSpeeds | None = None
    """Set points to draw as an arrow."""
    colour: str = INK
    """Colour of the arrow."""


def draw_sensor_view(axes: Axes, robot: RobotSettings, view: SensorView) -> None:
    """Draw one situation from above, in m: body, beams, readings and the predicted path."""
    counts, averages, differing = view.counts, view.averages, view.differing
    law = robot.infrared
    reach_m = law.far_m + _MARGIN_M
    half_length_m, half_width_m = robot.geometry.outline_length_m / 2, robot.geometry.outline_width_m / 2
    axes.set_xlim(-half_width_m - reach_m, half_width_m + reach_m)
    axes.set_ylim(-half_length_m - reach_m, half_length_m + reach_m)
    axes.set_aspect("equal")
    axes.set_axis_off()
    ends: dict[float, list[Point]] = {}
    for sensor in law.sensors:
        if sensor.name not in counts:
            continue
        distance_m = law.distance_m(counts[sensor.name])
        sees, differs = _is_detected(law, counts[sensor.name]), sensor.name in differing
        _beam(axes, sensor, distance_m, DIFFERS if differs else _BEAM if sees else _NOTHING, 0.55 if differs else 0.8)
        if sees:
            _wall(axes, sensor, distance_m)
            ends.setdefault(sensor.heading_deg, []).append(_along(sensor, distance_m))
        if differs:
            _label(axes, sensor, distance_m, f"{distance_m * 100:.0f} cm" if sees else "nothing", sees=sees)
        if sensor.name in averages:
            average_m = law.distance_m(averages[sensor.name])
            if _is_detected(law, averages[sensor.name]):
                axes.plot(*_along(sensor, average_m), "D", markersize=4.5, color=_AVERAGE, fillstyle="none", zorder=7)
    for side in ends.values():
        for one, other in pairwise(sorted(side)):
            if math.dist(one, other) <= _ONE_WALL_M:
                axes.plot(*zip(one, other, strict=True), color=_WALL, linewidth=3.2, solid_capstyle="round", zorder=5)
    _body(axes, robot)
    place = {sensor.name: sensor for sensor in law.sensors}
    for mark in view.marks:
        _mark(axes, place[mark.sensor], mark, aside=mark.sensor in differing)
    if view.motion is not None:
        _arrow(axes, robot, view.motion, view.colour)


def _is_detected(law: InfraredSettings, counts: float) -> bool:
    """Return whether a reading stands out from the noise at the end of the sensor's range."""
    return counts > law.floor_counts + 4 * law.noise_least_counts


def to_picture(x_m: float, y_m: float) -> Point:
    """Return picture coordinates of a point in the robot's frame (x forward, y left, m)."""
    return -y_m, x_m


def _along(sensor: SensorSettings, distance_m: float, aside_rad: float = 0.0) -> Point:
    heading_rad = math.radians(sensor.heading_deg) + aside_rad
    return to_picture(sensor.x_m + distance_m * math.cos(heading_rad), sensor.y_m + distance_m * math.sin(heading_rad))


def _beam(axes: Axes, sensor: SensorSettings, distance_m: float, colour: str, alpha: float) -> None:
    fan = [to_picture(sensor.x_m, sensor.y_m)]
    fan += [_along(sensor, distance_m, part * _HALF_BEAM_RAD) for part in (-1.0, -0.5, 0.0, 0.5, 1.0)]
    axes.add_patch(Polygon(fan, closed=True, facecolor=colour, edgecolor="none", alpha=alpha, zorder=2))


def _wall(axes: Axes, sensor: SensorSettings, distance_m: float) -> None:
    edge = [_along(sensor, distance_m, part * _HALF_BEAM_RAD) for part in (-1.0, -0.5, 0.0, 0.5, 1.0)]
    axes.plot(*zip(*edge, strict=True), color=_WALL, linewidth=3.2, solid_capstyle="round", zorder=5)


def _label(axes: Axes, sensor: SensorSettings, distance_m: float, text: str, *, sees: bool) -> None:
    """Write the text outside the detected wall, or on the fan if there is no wall."""
    sideways = abs(math.sin(math.radians(sensor.heading_deg))) > 0.9
    x, y = _along(sensor, distance_m + (0.03 if sideways else 0.06) if sees else 0.75 * distance_m)
    aside = sees and (sideways or sensor.heading_deg % 180 == 0) and x != 0
    if sees and x == 0:  # between those of its neighbours
        x, y = _along(sensor, distance_m + 0.12)
    axes.text(
        x,
        y,
        text,
        ha="center" if not aside else "right" if x < 0 else "left",
        va="center",
        fontsize=9.5,
        fontweight="bold",
        color=DIFFERS,
        zorder=8,
        bbox={"boxstyle": "round,pad=0.12", "facecolor": "white", "edgecolor": "none", "alpha": 0.8},
    )


def _mark(axes: Axes, sensor: SensorSettings, mark: SensorMark, *, aside: bool) -> None:
    """Draw a counterfactual mark. `aside`: leave room for the sensor's own label."""
    rise = 34 if aside else 16
    across = [_along(sensor, mark.distance_m, part * 2.2 * _HALF_BEAM_RAD) for part in (-1.0, 0.0, 1.0)]
    axes.plot(*zip(*across, strict=True), color=mark.colour, linewidth=2.6, linestyle=(0, (1.2, 0.8)), zorder=6)
    x, y = across[0] if sensor.heading_deg % 180 else across[2]
    axes.annotate(
        mark.text,
        (x, y),
        xytext=(-26 if x < 0 else 26, rise if y >= 0 else -rise),
        textcoords="offset points",
        ha="center",
        va="center",
        fontsize=8.5,
        color=INK,
        zorder=8,
        arrowprops={"arrowstyle": "-", "color": mark.colour, "linewidth": 0.8},
        path_effects=[patheffects.withStroke(linewidth=2.5, foreground="white")],
    )


def _body(axes: Axes, robot: RobotSettings) -> None:
    length_m, width_m = robot.geometry.outline_length_m, robot.geometry.outline_width_m
    for side in (-1, 1):
        for place in (-0.33, 0.0, 0.33):
            axes.add_patch(
                Rectangle(
                    (side * width_m * 0.5 - 0.022, place * length_m - 0.05),
                    0.044,
                    0.10,
                    facecolor=_WHEEL,
                    edgecolor="none",
                    zorder=3,
                )
            )
    axes.add_patch(
        FancyBboxPatch(
            (-width_m / 2 + 0.02, -length_m / 2 + 0.02),
            width_m - 0.04,
            length_m - 0.04,
            boxstyle="round,pad=0.02,rounding_size=0.035",
            facecolor=_BODY,
            edgecolor=INK,
            linewidth=1.3,
            zorder=4,
        )
    )
    nose = [(0.0, length_m * 0.43), (-width_m * 0.13, length_m * 0.31), (width_m * 0.13, length_m * 0.31)]
    axes.add_patch(Polygon(nose, closed=True, facecolor=INK, edgecolor="none", zorder=5))


def _arrow(axes: Axes, robot: RobotSettings, motion: WheelSpeeds, colour: str) -> None:
    """Draw the predicted path of the robot's centre; nothing at standstill."""
    way = predicted_path(motion, robot.geometry.effective_track_m, _ARROW_S)
    if way is None:
        if motion.right_m_s == motion.left_m_s:
            return
        way = _spin(turns_left=motion.right_m_s > motion.left_m_s)
    points = [to_picture(x_m, y_m) for x_m, y_m in way]
    edge: list[patheffects.AbstractPathEffect] = [patheffects.withStroke(linewidth=7.5, foreground=INK)]
    line = axes.plot(*zip(*points[:-1], strict=True), color=colour, linewidth=5, solid_capstyle="butt", zorder=8)
    line[0].set_path_effects(edge)
    axes.add_patch(
        FancyArrowPatch(
            points[-2],
            points[-1],
            arrowstyle="-|>",
            mutation_scale=26,
            facecolor=colour,
            edgecolor=INK,
            linewidth=1.2,
            shrinkA=0,
            shrinkB=0,
            zorder=9,
        )
    )


def _spin(*, turns_left: bool) -> list[Point]:
    side = 1 if turns_left else -1
    angles = [side * math.radians(-60 + 200 * step / 24) for step in range(25)]
    return [(0.11 * math.cos(angle), 0.11 * math.sin(angle)) for angle in angles]


def predicted_path(motion: WheelSpeeds, track_m: float, lasts_s: float) -> Sequence[Point] | None:
    """Return the predicted path of the centre in `lasts_s` seconds, as points in m in the robot's frame.

    `track_m`: distance between the wheels. Returns None for less than 3 cm, such as a turn on the spot.
    """
    speed_m_s = (motion.left_m_s + motion.right_m_s) / 2
    turn_rad_s = (motion.right_m_s - motion.left_m_s) / track_m
    if abs(speed_m_s) * lasts_s < 0.03:
        return None
    points = []
    for step in range(25):
        time_s = lasts_s * step / 24
        if abs(turn_rad_s) < 1e-6:
            points.append((speed_m_s * time_s, 0.0))
            continue
        bow_m, angle_rad = speed_m_s / turn_rad_s, turn_rad_s * time_s
        points.append((bow_m * math.sin(angle_rad), bow_m * (1 - math.cos(angle_rad))))
    return points
