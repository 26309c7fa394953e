"""`kurt2rt ros`: what it refuses, and its life next to a robot's program, a zenoh node and the end of its pairing."""

import signal
from contextlib import closing
from pathlib import Path

import pytest

from kurt2rt.channel.security.pairing import revoke
from kurt2rt.ros import messages as ros
from kurt2rt.ros.session import ZenohSession
from kurt2rt.ros.settings import RosSettings
from kurt2rt.ros.topic import topic_of, trigger_service
from tests.cli.helpers import CommandLine, running
from tests.ros.helpers import free_locator, wait_for
from tests.teacher.page.test_teach_command import free_udp_port


def test_device_that_is_not_paired_is_refused_with_the_remedy(kurt2rt: CommandLine) -> None:
    assert kurt2rt.refused("ros").endswith("make one on the robot's machine: kurt2rt pair ros")


@pytest.mark.deep
def test_device_waits_for_robot_and_router_and_serves_them(kurt2rt: CommandLine, tmp_path: Path) -> None:
    kurt2rt("pair", "ros")
    locator, port = free_locator(), str(free_udp_port())
    with running("ros", "--connect", locator, "--port", port, folder=tmp_path) as device:
        assert locator in device.wait_for("waiting for a zenoh router or bridge there")
        scans: list[bytes] = []
        with closing(ZenohSession(RosSettings(), listen=[locator])) as node:
            device.wait_for("no robot answers yet")
            with running("run", "--port", port, "--no-record", folder=tmp_path) as robot:
                device.wait_for("is in ROS 2")
                node.subscribe(topic_of("scan", ros.LaserScan), scans.append)
                wait_for(lambda: len(scans) >= 5)
                assert node.call(trigger_service("take"), timeout_s=30.0) == (True, "ros teaches")
                assert node.call(trigger_service("stop"), timeout_s=30.0)[0]
                assert robot.end(signal.SIGINT).exit_code == 0
            revoke(tmp_path / "var/teachers", tmp_path / "var/devices", "ros")
            said = device.process.wait()
            assert said == 2
            assert "its pairing was revoked" in (device.process.stderr.read() if device.process.stderr else "")
