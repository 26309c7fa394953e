"""The promises of every robot (kurt2rt.checks.plugins.robot_promises) hold for the base."""

from kurt2rt.checks.plugins.robot_promises import broken_of_robot
from kurt2rt.robots.turtlebot.kind import TURTLEBOT


def test_turtlebot_keeps_all_promises_of_a_robot() -> None:
    assert broken_of_robot(TURTLEBOT, "turtlebot") == []
