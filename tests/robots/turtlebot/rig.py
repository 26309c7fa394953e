"""Simulated base on topics in memory, one tick of the runtime after each cycle of the robot."""

from hal.linked_robot import LinkedRobot
from hal.robot import GuardResult, SensorReadings, WheelSpeeds
from hal.robot_settings import load_robot
from kurt2rt.robots.turtlebot.lidar import lidar_of
from kurt2rt.robots.turtlebot.settings import TurtlebotSettings, require_turtlebot
from kurt2rt.robots.turtlebot.simulated import LocalLink, TurtlebotElectronics
from kurt2rt.ros.messages import Message, encode
from kurt2rt.ros.topic import key_expression, topic_of
from simbridge.simulated_robot import SimulatedRobot
from simbridge.worlds.world_loading import load_world

SETTINGS: TurtlebotSettings = require_turtlebot(load_robot("turtlebot"))
FORWARD = WheelSpeeds(0.1, 0.1)


class MemoryRig:
    """Robot and driver in world A."""

    def __init__(self, settings: TurtlebotSettings = SETTINGS) -> None:
        self.link = LocalLink(settings)
        self.simulated = SimulatedRobot(
            settings, load_world("turtlebot/a", settings), self.link.make_controller, 1, make_sensors=lidar_of
        )
        controller = self.simulated.controller
        assert isinstance(controller, TurtlebotElectronics)
        self.electronics = controller
        self.settings = settings
        self.now_s = 100.0
        self.robot = LinkedRobot(settings, self.link.runtime_end, lambda: self.now_s)
        self.readings: SensorReadings = self.robot.sense(self.now_s)

    def tick(self, wanted: WheelSpeeds = FORWARD, *, steps: bool = True) -> GuardResult:
        self.now_s += self.settings.cycle_s
        if steps:
            self.simulated.step()
        self.readings = self.robot.sense(self.now_s)
        return self.robot.drive(wanted, self.now_s, self.now_s)

    def run(self, seconds: float, wanted: WheelSpeeds = FORWARD) -> GuardResult:
        for _ in range(round(seconds / self.settings.cycle_s)):
            result = self.tick(wanted)
        return result

    def send(self, name: str, message: Message) -> None:
        """Send a message as another program."""
        self.send_bytes(name, type(message), encode(message))

    def send_bytes(self, name: str, kind: type[Message], payload: bytes) -> None:
        """Send bytes on a topic as another program."""
        self.link.topics.carry(key_expression(topic_of(name, kind), self.settings.ros), payload)
