"""The base passes the tests of every robot (kurt2rt.checks.plugins.robot_tests)."""

from kurt2rt.checks.plugins.robot_tests import RobotTests
from kurt2rt.robots.turtlebot.kind import TURTLEBOT


class TestTurtlebot(RobotTests):
    kind = TURTLEBOT
