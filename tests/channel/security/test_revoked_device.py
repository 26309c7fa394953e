"""A device that is revoked or renewed while it looks leaves no trouble behind."""

import asyncio
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from kurt2rt.channel.security.pairing import pair, renew, revoke
from kurt2rt.core.outcome import ResultCode
from tests.channel.device_by_the_book import Device
from tests.channel.jumping_loop import run_jumping
from tests.channel.robot_at_work import RobotAtWork, robot_at_work

_TAKEN_UP_S = 2.0
"""The robot looks for new pairings once a second."""


async def phone_in(folder: Path) -> Path:
    """Pair a device and move its folder elsewhere."""
    paired = pair(folder / "teachers", folder / "devices", "phone")
    await asyncio.sleep(_TAKEN_UP_S)
    elsewhere = folder / "elsewhere"
    shutil.copytree(paired.device.folder, elsewhere)
    return elsewhere


def untroubled(at_work: RobotAtWork) -> bool:
    channel = at_work.channel
    return (channel.trouble, channel.failures, channel.endpoint.counters.failed) == ("", 0, 0)


@pytest.mark.parametrize("end", [revoke, renew], ids=["revoked", "renewed"])
def test_revoked_observer_gets_no_state_and_no_trouble(
    tmp_path: Path, end: Callable[[Path, Path, str], object]
) -> None:
    async def story() -> None:
        async with robot_at_work(tmp_path) as at_work:
            async with Device(await phone_in(tmp_path), at_work.port) as device:
                looking = await device.look()
                for _ in range(10):
                    await looking.picture()
                assert at_work.channel.site.observers == 1
                end(tmp_path / "teachers", tmp_path / "devices", "phone")
                await asyncio.sleep(_TAKEN_UP_S)
                assert at_work.channel.site.observers == 0
                assert untroubled(at_work)
                with pytest.raises(TimeoutError):
                    await device.ask("/hello", [])
            # Another one is not touched by it.
            async with Device(at_work.pairing.device.folder, at_work.port) as other:
                assert (await (await other.look()).picture())["t"] > 0
            assert untroubled(at_work)

    run_jumping(story)


def test_revoked_teacher_leaves_robot_standing_and_free(tmp_path: Path) -> None:
    async def story() -> None:
        async with robot_at_work(tmp_path) as at_work:
            async with Device(await phone_in(tmp_path), at_work.port) as device:
                picture = await (await device.look()).picture()
                taken = await device.ask("/take", [picture["b"], bytes(8), picture["t"]])
                assert taken.body["code"] == ResultCode.TAKEN
                revoke(tmp_path / "teachers", tmp_path / "devices", "phone")
                await asyncio.sleep(_TAKEN_UP_S)
            assert at_work.runtime.handler.authority.teacher is None
            async with Device(at_work.pairing.device.folder, at_work.port) as other:
                picture = await (await other.look()).picture()
                assert picture["by"] == "stopped"
                assert (await other.ask("/take", [picture["b"], bytes(8), picture["t"]])).body["ok"]
            assert untroubled(at_work)

    run_jumping(story)
