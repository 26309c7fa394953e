"""Imports of the base's plug-in: nothing of ROS for other robots, and the extra's name where it is missing."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.helpers import CommandLine
from tests.ros.helpers import free_locator

_LOOK = """
import sys
from hal.robot_settings import load_robot
import kurt2rt.cli.main
load_robot({robot!r})
print(sorted({{"zenoh", "rosbags", "pymunk"}} & sys.modules.keys()))
"""


@pytest.mark.parametrize("robot", ["kurt2", "turtlebot"])
def test_settings_of_a_robot_import_nothing_of_ros(robot: str) -> None:
    done = subprocess.run([sys.executable, "-c", _LOOK.format(robot=robot)], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_run_without_the_extra_names_it(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in [name for name in sys.modules if name.startswith(("kurt2rt.ros.", "kurt2rt.robots.turtlebot.link"))]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "rosbags.interfaces", None)
    words = ("run", "--robot-settings", "turtlebot", "--task", "turtlebot/circle", "--bus", free_locator())
    assert CommandLine(monkeypatch, capfd).refused(*words).endswith("pip install '.[ros]' in kurt2rt's folder")
