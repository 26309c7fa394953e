"""A ROS device over real zenoh on loopback, in real time, with a node of another session and foreign programs."""

import asyncio
from contextlib import closing
from pathlib import Path

import anyio
import anyio.to_thread
import pytest

from hal.robot import STANDSTILL
from kurt2rt.ros import messages as ros
from kurt2rt.ros.session import ZenohSession
from kurt2rt.ros.settings import Naming, RosSettings
from kurt2rt.ros.topic import topic_of, trigger_service
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.ros.device import RosDevice
from tests.channel.robot_at_work import robot_at_work
from tests.ros import foreign
from tests.ros.helpers import free_locator
from tests.teacher.ros.robot_in_ros import twist

"""Another implementation of rmw_zenoh's names, hashes and attachments, which computes the type's hash itself."""


@pytest.mark.parametrize("naming", [Naming.BRIDGE, Naming.RMW_ZENOH])
async def test_node_takes_teaches_and_drives_over_zenoh(naming: Naming, tmp_path: Path) -> None:
    settings, locator = RosSettings(naming=naming, namespace="kurt2"), free_locator()
    scans: list[bytes] = []
    async with robot_at_work(tmp_path) as at_work, anyio.create_task_group() as tasks:
        with (
            closing(ZenohSession(settings, listen=[locator])) as session,
            closing(ZenohSession(settings, connect=[locator])) as node,
        ):
            async with TeacherClient(at_work.pairing.device.folder, port=at_work.port) as client:
                node.subscribe(topic_of("scan", ros.LaserScan), scans.append)
                tasks.start_soon(RosDevice(client, session, lambda _: None).run)
                await at_work.until(lambda: bool(scans))
                assert foreign.LaserScan.deserialize(scans[-1]).header.frame_id == "base_link"

                async def call(name: str) -> tuple[bool, str]:
                    return await anyio.to_thread.run_sync(
                        lambda: node.call(trigger_service(name), timeout_s=30.0), abandon_on_cancel=True
                    )

                assert await call("take") == (True, "local teaches")
                assert await call("teach/forward") == (True, "RLA 1 taught: forward")
                publisher = node.publisher(topic_of("cmd_vel", ros.Twist))

                async def drive() -> None:
                    while True:
                        publisher.publish(twist(0.2))
                        await asyncio.sleep(0.05)

                async with anyio.create_task_group() as driving:
                    driving.start_soon(drive)
                    await at_work.until(lambda: at_work.records[-1].decision.action == "by hand")
                    assert at_work.records[-1].guard_result.wheel_speeds != STANDSTILL
                    driving.cancel_scope.cancel()
                await at_work.until(lambda: at_work.records[-1].guard_result.wheel_speeds == STANDSTILL)
            tasks.cancel_scope.cancel()
