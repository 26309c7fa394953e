"""A robot in ROS 2: who drives it, until when, and what it is taught. In simulated time, over real sockets and keys."""

import functools
import math
from collections.abc import Awaitable, Callable
from pathlib import Path

import anyio

from hal.robot import STANDSTILL, WheelSpeeds
from kurt2rt.core.teaching.commands import Take
from kurt2rt.ros import messages as ros
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.ros.services import MOST_REQUESTS
from kurt2rt.teacher.ros.twist_drive import LEASE_S
from tests.channel.jumping_loop import run_jumping
from tests.channel.robot_at_work import PERIOD_S, REACH_TICKS, SETTINGS
from tests.teacher.ros.robot_in_ros import EPOCH_S, RobotInRos, robot_in_ros, twist

STOPS_WITHIN = round(LEASE_S / PERIOD_S) + REACH_TICKS
"""Most ticks from the last twist of a node to the last one in which the wheels turn."""
OK, WARN, ERROR = ros.DiagnosticStatus.OK, ros.DiagnosticStatus.WARN, ros.DiagnosticStatus.ERROR
Story = Callable[[RobotInRos], Awaitable[None]]


def in_ros(story: Story, *, stamped: bool = False) -> Callable[[Path], None]:
    """Return the test of a story, in which the device's teacher has taken the robot."""

    @functools.wraps(story)
    def test(tmp_path: Path) -> None:
        async def run() -> None:
            async with robot_in_ros(tmp_path, stamped=stamped) as desk:
                assert await desk.call("take") == (True, "local teaches")
                await story(desk)

        run_jumping(run)

    del test.__wrapped__  # pytest would ask for the story's arguments
    return test


@in_ros
async def test_states_become_scan_odometry_and_transform(desk: RobotInRos) -> None:
    desk.received["scan"].clear()
    desk.received["odom"].clear()
    await anyio.sleep(1.0)
    assert 19 <= len(desk.received["scan"]) <= 21
    assert len(desk.received["odom"]) == len(desk.received["scan"])
    scan = desk.messages("scan", ros.LaserScan)[-1]
    assert scan.header.frame_id == "base_link"
    assert abs(ros.to_seconds(scan.header.stamp) - EPOCH_S) < 60.0
    odometry = desk.messages("odom", ros.Odometry)[-1]
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("odom", "base_link")
    (moved,) = desk.messages("/tf", ros.TFMessage)[-1].transforms
    assert (moved.header.frame_id, moved.child_frame_id) == ("odom", "base_link")


@in_ros
async def test_twists_drive_the_teachers_robot_until_they_cease(desk: RobotInRos) -> None:
    await desk.drive(0.2, 0.5, 1.0)
    half_m_s = 0.25 * SETTINGS.geometry.effective_track_m
    assert desk.at_work.records[-1].decision.wheel_speeds == WheelSpeeds(0.2 - half_m_s, 0.2 + half_m_s)
    ceased = desk.at_work.tick
    await anyio.sleep(2.0)
    assert 0 < desk.moved_after(ceased) <= STOPS_WITHIN
    assert desk.at_work.runtime.handler.stops.active is not None


@in_ros
async def test_zero_twists_do_not_take_the_wheels_of_a_taught_robot(desk: RobotInRos) -> None:
    await desk.call("teach/forward")
    async with anyio.create_task_group() as tasks:
        tasks.start_soon(desk.send, "watch", ros.String(""), 2.0)
        await desk.call("resume")
        begun = desk.at_work.tick
        await desk.drive(0.0, 0.0, 1.0)
        assert desk.moved_after(begun) >= 90


@in_ros
async def test_refused_twist_ends_the_drive_until_twists_cease(desk: RobotInRos) -> None:
    for wrong in (ros.encode(twist(math.nan)), ros.encode(twist(1.5)), b"\x00\x01junk"):
        await desk.call("take")
        await desk.drive(0.2, 0.0, 0.5)
        assert desk.at_work.records[-1].decision.wheel_speeds == WheelSpeeds(0.2, 0.2)
        refused = desk.at_work.tick
        desk.topics.carry("cmd_vel", wrong)
        await anyio.sleep(0.05)
        await desk.drive(0.2, 0.0, 1.0)  # goes on as if nothing had been
        assert desk.moved_after(refused) <= 10
        await anyio.sleep(LEASE_S + 0.1)
        await desk.drive(0.2, 0.0, 0.5)
        assert desk.at_work.records[-1].decision.wheel_speeds == WheelSpeeds(0.2, 0.2)
        await anyio.sleep(2.0)
        assert desk.at_work.records[-1].guard_result.wheel_speeds == STANDSTILL
        assert (await desk.statuses())["cmd_vel"] == (OK, "no twist drives")


@in_ros
async def test_stop_of_another_teacher_holds_against_twists(desk: RobotInRos) -> None:
    async with TeacherClient(desk.at_work.other.device.folder, port=desk.at_work.port) as other:
        await desk.drive(0.2, 0.0, 0.5)
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(desk.drive, 0.2, 0.0, 2.0)
            await anyio.sleep(0.2)
            assert desk.at_work.records[-1].guard_result.wheel_speeds != STANDSTILL
            await other.stop()
            stopped = desk.at_work.tick
            await anyio.sleep(0.5)
            # The robot may drive again, but not by twists from before.
            assert (await desk.call("resume"))[0]
        assert desk.moved_after(stopped) <= 1
        await anyio.sleep(LEASE_S + 0.1)
        await desk.drive(0.2, 0.0, 0.5)
        assert desk.at_work.records[-1].guard_result.wheel_speeds != STANDSTILL


@in_ros
async def test_robot_that_another_teacher_took_refuses_twists(desk: RobotInRos) -> None:
    async with TeacherClient(desk.at_work.other.device.folder, port=desk.at_work.port) as other:
        assert (await other.send(Take)).accepted
        taken = desk.at_work.tick
        await desk.drive(0.2, 0.0, 1.0)
        assert desk.moved_after(taken) == 0
        success, text = await desk.call("teach/forward")
        assert not success
        assert "auto" in text


@in_ros
async def test_taught_robot_drives_only_while_a_node_watches(desk: RobotInRos) -> None:
    success, text = await desk.call("teach/forward")
    assert (success, text) == (True, "RLA 1 taught: forward")
    await desk.call("resume")
    begun = desk.at_work.tick
    await anyio.sleep(1.0)
    assert desk.moved_after(begun) == 0
    assert (await desk.statuses())["robot"][0] == WARN
    await desk.call("resume")
    async with anyio.create_task_group() as tasks:
        tasks.start_soon(desk.send, "watch", ros.String("a node"), 1.0)
        await anyio.sleep(0.2)
        await desk.call("resume")
    ceased = desk.at_work.tick
    assert desk.at_work.records[-1].guard_result.wheel_speeds != STANDSTILL
    await anyio.sleep(2.0)
    assert 0 < desk.moved_after(ceased) <= STOPS_WITHIN


@in_ros
async def test_too_many_requests_are_refused_but_a_stop_is_not(desk: RobotInRos) -> None:
    waiting = [desk.services.begin("undo") for _ in range(MOST_REQUESTS + 3)]
    refused = [each.result() for each in waiting if each.done()]
    assert refused == [(False, "too many requests are under way; wait for their answers")] * 3
    assert (await desk.call("stop"))[0]
    assert {(await each)[0] for each in waiting} == {False}  # nothing was taught that could be undone


@functools.partial(in_ros, stamped=True)
async def test_stamped_twists_drive_while_they_are_young(desk: RobotInRos) -> None:
    async def drive(age_s: float) -> None:
        for _ in range(25):
            stamp = ros.to_time(EPOCH_S + anyio.current_time() - age_s)
            await desk.send("cmd_vel", ros.TwistStamped(ros.Header(stamp, ""), twist(0.2)), 0.05)

    for age_s, says in ((0.0, "drives"), (0.1, "drives"), (0.3, "the twist is 0.30 s old, allowed is 0.25")):
        begun = desk.at_work.tick
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(drive, age_s)
            await anyio.sleep(0.2)
            assert (await desk.statuses())["cmd_vel"][1] == says
        assert (desk.moved_after(begun) > 0) is (says == "drives"), age_s
        await anyio.sleep(2.0)


@in_ros
async def test_request_without_a_robot_is_answered_with_no(desk: RobotInRos) -> None:
    desk.at_work.end()
    await desk.at_work.until(lambda: desk.at_work.ended)
    success, text = await desk.call("stop")
    assert not success
    assert "the stop is not answered" in text
    assert (await desk.statuses())["teacher's channel"][0] == ERROR


@in_ros
async def test_lost_topics_stop_robot_that_drives_by_hand(desk: RobotInRos) -> None:
    async with anyio.create_task_group() as tasks:
        tasks.start_soon(desk.drive, 0.2, 0.0, 3.0)
        await anyio.sleep(0.5)
        assert desk.at_work.records[-1].guard_result.wheel_speeds != STANDSTILL
        desk.topics.connected = False
        lost = desk.at_work.tick
    assert 0 < desk.moved_after(lost) <= STOPS_WITHIN
