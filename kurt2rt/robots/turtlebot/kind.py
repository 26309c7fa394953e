"""The base as a kind of robot (simbridge.contracts.robot_kind.RobotKind)."""

from pathlib import Path

from hal.guarded_robot import GuardedRobot
from hal.robot_settings import RobotSettings
from hal.tap import Tap, refuse_tap
from kurt2rt.robots.turtlebot.settings import TurtlebotSettings, require_turtlebot
from simbridge.contracts.simulation import SimulationFactory


class TurtlebotKind:
    """Base on topics of ROS 2 over zenoh, or simulated on topics in memory."""

    settings: type[RobotSettings] = TurtlebotSettings
    folder: Path = Path(__file__).parent / "data"

    def open(self, settings: RobotSettings, address: str, tap: Tap | None = None) -> GuardedRobot:
        """Return the driver of the robot behind the locator `address`, such as tcp/127.0.0.1:7447.

        Raises hal.bus.BusError if nothing answers there, SettingsError for a tap, which sees CAN frames.
        """
        from hal.linked_robot import LinkedRobot
        from kurt2rt.robots.turtlebot.link import TurtlebotLink
        from kurt2rt.ros.session import ZenohSession

        checked = require_turtlebot(settings)
        refuse_tap(tap, settings.name)
        session = ZenohSession(checked.ros, connect=[address])
        return LinkedRobot(checked, TurtlebotLink(checked, session, session.name))

    def simulations(self, settings: RobotSettings) -> SimulationFactory:
        """Return the factory of simulations over topics within this program."""
        from kurt2rt.robots.turtlebot.lidar import lidar_of
        from kurt2rt.robots.turtlebot.simulated import LocalLink
        from simbridge.simulation import LinkSimulationFactory

        return LinkSimulationFactory(settings, open_link=LocalLink, make_sensors=lidar_of)

    def serve(self, settings: RobotSettings, address: str) -> object:
        """Return a simulated robot's end of topics at the locator `address`, such as tcp/127.0.0.1:7447.

        Raises hal.bus.BusError if nothing can listen there.
        """
        from kurt2rt.robots.turtlebot.lidar import lidar_of
        from kurt2rt.robots.turtlebot.simulated import TurtlebotElectronics
        from kurt2rt.ros.inbox import MachineClock
        from kurt2rt.ros.session import ZenohSession
        from simbridge.links import LinkRobotEnd

        checked, clock = require_turtlebot(settings), MachineClock()
        session = ZenohSession(checked.ros, listen=[address])
        return LinkRobotEnd(checked, session, lambda *_: TurtlebotElectronics(checked, session, clock), lidar_of)


TURTLEBOT = TurtlebotKind()
