"""Foxglove messages of a run: scan, pose, transforms, scene and log."""

import math
from collections.abc import Sequence
from typing import NamedTuple

from foxglove.messages import (
    ArrowPrimitive,
    Color,
    CubePrimitive,
    CylinderPrimitive,
    Duration,
    FrameTransform,
    FrameTransforms,
    LaserScan,
    LinePrimitive,
    LinePrimitiveLineType,
    Point3,
    Pose,
    PoseInFrame,
    Quaternion,
    SceneEntity,
    SceneUpdate,
    TextPrimitive,
    Timestamp,
    Vector3,
)

from hal.odometry import PlanePose
from hal.robot_settings import InfraredSettings, RobotSettings
from kurt2rt.core.decision.decision import Decision
from kurt2rt.core.rla.rla import rla_title
from simbridge.contracts.simulation import WorldPlan

ROBOT, START, WORLD = "robot", "start", "world"
"""Frames: the robot's centre; where it was switched on, by its encoders; the simulated world."""

_DRIVES = Color(r=0.15, g=0.55, b=0.3, a=1.0)
_ASKS = Color(r=0.9, g=0.6, b=0.1, a=1.0)
_STANDS = Color(r=0.7, g=0.2, b=0.2, a=1.0)
_RAY = Color(r=0.2, g=0.45, b=0.8, a=0.9)
_FAR_RAY = Color(r=0.6, g=0.6, b=0.6, a=0.35)
_AHEAD = Color(r=1.0, g=1.0, b=1.0, a=0.9)
_WALL = Color(r=0.55, g=0.55, b=0.55, a=1.0)
_WALL_HEIGHT_M = 0.15
_ROBOT_HEIGHT_M = 0.25
_RAY_HEIGHT_M = 0.1
_TEXT_HEIGHT_M = 0.7


SCAN_STEP_DEG = 3
SCAN_RAYS = 360 // SCAN_STEP_DEG


class Ray(NamedTuple):
    """Line from a sensor to the obstacle that it reads, or to its range; x forward, y left, in m."""

    from_x_m: float
    from_y_m: float
    to_x_m: float
    to_y_m: float
    seen: bool
    """True if it ends at an obstacle; otherwise it ends at the sensor's range."""


class SensorRays:
    """Converter of infra-red counts to rays of the sensors, and to a scan with equal angles."""

    def __init__(self, infrared: InfraredSettings) -> None:
        self._infrared = infrared
        self._places = [
            (sensor.x_m, sensor.y_m, math.cos(heading_rad), math.sin(heading_rad))
            for sensor in infrared.sensors
            for heading_rad in [math.radians(sensor.heading_deg)]
        ]

    def rays(self, counts: Sequence[int]) -> list[Ray]:
        """Return the ray of each sensor in the order of `counts`."""
        infrared = self._infrared
        rays = []
        for (x_m, y_m, dx, dy), count in zip(self._places, counts, strict=True):
            away_m = infrared.distance_m(count)
            rays.append(Ray(x_m, y_m, x_m + away_m * dx, y_m + away_m * dy, away_m < infrared.far_m))
        return rays

    def scan_m(self, counts: Sequence[int]) -> list[float]:
        """Return distances from the centre, counter-clockwise from x every SCAN_STEP_DEG; infinite without obstacle.

        A sensor's hit is entered in the nearest ray, at most half a step off.
        """
        ranges = [math.inf] * SCAN_RAYS
        for ray in self.rays(counts):
            if ray.seen:
                place = round(math.degrees(math.atan2(ray.to_y_m, ray.to_x_m)) / SCAN_STEP_DEG) % SCAN_RAYS
                ranges[place] = min(ranges[place], math.hypot(ray.to_x_m, ray.to_y_m))
        return ranges


def timestamp(time_ns: int) -> Timestamp:
    """Return nanoseconds since 1970 as a Foxglove timestamp."""
    return Timestamp(time_ns // 1_000_000_000, time_ns % 1_000_000_000)


def pose_in(frame: str, pose: PlanePose, time_ns: int) -> PoseInFrame:
    """Return a pose on the floor in the frame of this name; `time_ns` in ns since 1970."""
    return PoseInFrame(timestamp=timestamp(time_ns), frame_id=frame, pose=_pose(pose))


def transforms(moves: Sequence[tuple[str, str, PlanePose]], time_ns: int) -> FrameTransforms:
    """Return the pose of each child frame in its parent, from (parent, child, pose)."""
    moved = [
        FrameTransform(
            timestamp=timestamp(time_ns),
            parent_frame_id=parent,
            child_frame_id=child,
            translation=Vector3(x=pose.x_m, y=pose.y_m, z=0.0),
            rotation=_turned(pose.heading_rad),
        )
        for parent, child, pose in moves
    ]
    return FrameTransforms(transforms=moved)


class RobotScene:
    """Builder of one robot's messages for Foxglove: the readings as a laser scan, the robot as a scene."""

    def __init__(self, settings: RobotSettings) -> None:
        self._length_m = settings.geometry.outline_length_m
        self._width_m = settings.geometry.outline_width_m
        self._rays = SensorRays(settings.infrared)

    def scan(self, counts: Sequence[int], time_ns: int) -> LaserScan:
        """Return the infra-red counts as a laser scan from the robot's centre."""
        return LaserScan(
            timestamp=timestamp(time_ns),
            frame_id=ROBOT,
            pose=_pose(PlanePose(0.0, 0.0, 0.0), _RAY_HEIGHT_M),
            start_angle=0.0,
            end_angle=math.radians(360 - SCAN_STEP_DEG),
            ranges=self._rays.scan_m(counts),
        )

    def scene(self, counts: Sequence[int], decision: Decision, behaviour: str, time_ns: int) -> SceneUpdate:
        """Return the robot's outline with its heading, sensor rays and decision text."""
        points: list[Point3] = []
        colors: list[Color] = []
        for ray in self._rays.rays(counts):
            points.append(Point3(x=ray.from_x_m, y=ray.from_y_m, z=_RAY_HEIGHT_M))
            points.append(Point3(x=ray.to_x_m, y=ray.to_y_m, z=_RAY_HEIGHT_M))
            colors += [_RAY if ray.seen else _FAR_RAY] * 2
        color = _DRIVES if decision.driving else _ASKS if decision.asking else _STANDS
        body = CubePrimitive(
            pose=_pose(PlanePose(0.0, 0.0, 0.0), _ROBOT_HEIGHT_M / 2),
            size=Vector3(x=self._length_m, y=self._width_m, z=_ROBOT_HEIGHT_M),
            color=color,
        )
        ahead = ArrowPrimitive(
            pose=_pose(PlanePose(-self._length_m / 4, 0.0, 0.0), _ROBOT_HEIGHT_M + 0.02),
            shaft_length=self._length_m / 4,
            shaft_diameter=0.04,
            head_length=self._length_m / 4,
            head_diameter=0.12,
            color=_AHEAD,
        )
        text = TextPrimitive(
            pose=_pose(PlanePose(0.0, 0.0, 0.0), _TEXT_HEIGHT_M),
            billboard=True,
            font_size=14.0,
            scale_invariant=True,
            color=color,
            text=describe_decision(decision, behaviour),
        )
        rays = LinePrimitive(
            type=LinePrimitiveLineType.LineList,
            pose=_pose(PlanePose(0.0, 0.0, 0.0)),
            thickness=0.008,
            points=points,
            colors=colors,
        )
        entity = SceneEntity(
            timestamp=timestamp(time_ns),
            frame_id=ROBOT,
            id="robot",
            frame_locked=True,
            cubes=[body],
            arrows=[ahead],
            lines=[rays],
            texts=[text],
        )
        return SceneUpdate(entities=[entity])


def world_scene(world: WorldPlan, time_ns: int) -> SceneUpdate:
    """Return the walls and posts of the simulated world."""
    outlines = [corners for corners in (world.outline, *(wall.corners for wall in world.walls)) if corners]
    lines = [
        LinePrimitive(
            type=LinePrimitiveLineType.LineLoop,
            pose=_pose(PlanePose(0.0, 0.0, 0.0)),
            thickness=0.02,
            points=[Point3(x=x_m, y=y_m, z=_WALL_HEIGHT_M) for x_m, y_m in corners],
            color=_WALL,
        )
        for corners in outlines
    ]
    posts = [
        CylinderPrimitive(
            pose=_pose(PlanePose(post.x_m, post.y_m, 0.0), _WALL_HEIGHT_M / 2),
            size=Vector3(x=2 * post.radius_m, y=2 * post.radius_m, z=_WALL_HEIGHT_M),
            bottom_scale=1.0,
            top_scale=1.0,
            color=_WALL,
        )
        for post in world.posts
    ]
    entity = SceneEntity(
        timestamp=timestamp(time_ns),
        frame_id=WORLD,
        id="world",
        lifetime=Duration(0, 0),
        lines=lines,
        cylinders=posts,
    )
    return SceneUpdate(entities=[entity])


def describe_decision(decision: Decision, behaviour: str) -> str:
    """Return the source of the wheel speeds in a few words."""
    if decision.action is not None and decision.rla_id is not None:
        return f"{decision.action} by {rla_title(decision.rla_id, behaviour)}"
    if decision.action is not None:
        return f"{decision.action}, as the teacher says"
    return "asks" if decision.asking else f"stands: {decision.cause.value}"


def _pose(pose: PlanePose, height_m: float = 0.0) -> Pose:
    return Pose(position=Vector3(x=pose.x_m, y=pose.y_m, z=height_m), orientation=_turned(pose.heading_rad))


def _turned(heading_rad: float) -> Quaternion:
    return Quaternion(x=0.0, y=0.0, z=math.sin(heading_rad / 2), w=math.cos(heading_rad / 2))
