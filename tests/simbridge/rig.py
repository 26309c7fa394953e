"""Builders of worlds, and a simulated robot with the notebook's end of its bus."""

import itertools
import math
from collections.abc import Iterable
from typing import Self

import pytest

from config.settings import SettingsError
from hal.bus import open_bus
from hal.codec import Codec, load_codec
from hal.control import Control, Mode, SpeedControl, control_frame
from hal.kurt2_settings import Kurt2Settings, load_kurt2
from simbridge.contracts.simulation import Pose
from simbridge.robot.ray_caster import RayCaster
from simbridge.robot.world import World
from simbridge.simulated_robot import SimulatedKurt2
from simbridge.worlds.geometry import Point
from simbridge.worlds.obstacle_settings import PolygonObstacleSettings, RoundObstacleSettings, WallSettings
from simbridge.worlds.world_loading import load_world
from simbridge.worlds.world_settings import StartPoseSettings, WorldSettings

CODEC: Codec = load_codec()
ROBOT: Kurt2Settings = load_kurt2()
STAND = SpeedControl(Mode.SPEED_CM, 0, 0)

_numbers = itertools.count()


def board(from_m: Point, to_m: Point, thickness_m: float = 0.02) -> WallSettings:
    return WallSettings(name="board", from_m=from_m, to_m=to_m, thickness_m=thickness_m)


def box(*corners: Point, name: str = "box") -> PolygonObstacleSettings:
    return PolygonObstacleSettings(name=name, corners=corners)


def post(x_m: float, y_m: float, radius_m: float, name: str = "post") -> RoundObstacleSettings:
    return RoundObstacleSettings(name=name, x_m=x_m, y_m=y_m, radius_m=radius_m)


def room(
    side_m: float = 4.0,
    walls: Iterable[WallSettings] = (),
    posts: Iterable[RoundObstacleSettings] = (),
    boxes: Iterable[PolygonObstacleSettings] = (),
    rays: int = 1,
) -> WorldSettings:
    """Return a square room with the robot in the middle, looking along x."""
    return WorldSettings(
        name="room",
        size_m=(side_m, side_m),
        infrared_rays=3 if rays == 3 else 1,
        outline=((0.0, 0.0), (side_m, 0.0), (side_m, side_m), (0.0, side_m), (0.0, 0.0)),
        walls=tuple(walls),
        round_obstacles=tuple(posts),
        polygon_obstacles=tuple(boxes),
        start_poses=(StartPoseSettings(x_m=side_m / 2, y_m=side_m / 2, heading_deg=0.0),),
    )


class Rig:
    """Robot and notebook; `heard` holds the newest values of each message from the robot."""

    def __init__(
        self,
        world: WorldSettings | None = None,
        seed: int = 1,
        robot: Kurt2Settings = ROBOT,
        robot_seed: int | None = None,
    ) -> None:
        name = f"virtual:simbridge-test-{next(_numbers)}"
        self.robot_end, self.notebook = open_bus(name), open_bus(name)
        self._control_port = self.notebook.control_port()
        self.robot = SimulatedKurt2(robot, world or room(), self.robot_end, seed, robot_seed=robot_seed)
        self.heard: dict[str, tuple[int, ...]] = {}
        self.frames = 0
        self.ticks = [0, 0]
        self._speeds_cm_s = (0, 0)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.robot_end.shutdown()
        self.notebook.shutdown()

    def tell(self, control: Control) -> None:
        self._control_port.send(control_frame(control))

    def step(self, control: Control | None = None) -> None:
        """Simulate one cycle after at most one CONTROL frame."""
        if control is not None:
            self.tell(control)
        self.robot.step()
        self.listen()

    def run(self, seconds: float, control: Control | None = None) -> None:
        for _ in range(round(seconds / 0.01)):
            self.step(control)

    def drive(self, left_cm_s: int, right_cm_s: int, seconds: float) -> None:
        """Drive with set points that change by at most 3 cm/s per cycle."""
        for _ in range(round(seconds / 0.01)):
            left, right = self._speeds_cm_s
            self._speeds_cm_s = (left + max(-3, min(3, left_cm_s - left)), right + max(-3, min(3, right_cm_s - right)))
            self.step(SpeedControl(Mode.SPEED_CM, *self._speeds_cm_s))

    def listen(self) -> None:
        messages = self.notebook.drain()
        self.frames = len(messages)
        for message in messages:
            codec = CODEC.by_id[message.arbitration_id]
            self.heard[codec.name] = codec.unpack(message.data)
            if codec.name == "ENCODER":
                self.ticks[0] += self.heard["ENCODER"][0]
                self.ticks[1] += self.heard["ENCODER"][1]

    @property
    def speed_m_s(self) -> float:
        """Return the mean rim speed of both sides by the encoders."""
        left, right = self.heard["ENCODER"]
        return (left + right) / 2 * ROBOT.geometry.metres_per_tick / ROBOT.cycle_s

    def reading(self, sensor: str) -> int:
        """Return the newest count of a sensor on the bus."""
        channel = next(each.channel for each in ROBOT.infrared.sensors if each.name == sensor)
        for name, values in self.heard.items():
            signals = CODEC.message(name).signals
            if channel in signals:
                return values[signals.index(channel)]
        raise LookupError(f"{channel} was never heard")

    def readings(self, sensor: str, seconds: float) -> list[int]:
        """Stand for this time, and return a sensor's count of each cycle."""
        found = []
        for _ in range(round(seconds / 0.01)):
            self.step(STAND)
            found.append(self.reading(sensor))
        return found

    def seen_from(self, pose: Pose, sensor: str) -> int:
        """Return a sensor's count after 0.1 s at a pose."""
        self.robot.place(pose)
        self.run(0.1, STAND)
        return self.reading(sensor)


def facing_wall(distance_m: float, side_m: float = 4.0) -> Pose:
    """Return a pose in the square room that faces the wall at x = side at this distance of the front sensors."""
    return Pose(side_m - distance_m - ROBOT.geometry.outline_length_m / 2, side_m / 2, 0.0)


def quiet_robot(**infrared: float) -> Kurt2Settings:
    """Return the shipped robot without sensor noise and spread; `infrared` changes other settings."""
    update = {"noise_share": 0.0, "noise_least_counts": 0.0, "gain_spread_share": 0.0, **infrared}
    return ROBOT.model_copy(update={"infrared": ROBOT.infrared.model_copy(update=update)})


def left_clearances_m(world: WorldSettings, start: int) -> list[float]:
    """Return the distance to the wall on the left of each left sensor at a start pose."""
    pose = world.start_poses[start].pose
    cos, sin = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
    rays = RayCaster(World(world), 2.0)
    rays.set_origin(pose.x_m, pose.y_m)
    return [
        rays.distance_m(
            pose.x_m + sensor.x_m * cos - sensor.y_m * sin,
            pose.y_m + sensor.x_m * sin + sensor.y_m * cos,
            -sin,
            cos,
            1.5,
        )
        for sensor in ROBOT.infrared.sensors
        if sensor.heading_deg == 90
    ]


def refusal(source: str) -> str:
    """Return the error of loading a world."""
    with pytest.raises(SettingsError) as caught:
        load_world(source, ROBOT)
    return str(caught.value)
