"""docs/the-wire.md is enough for a device in another language: one that uses nothing else teaches and stops a robot."""

import ast
import secrets
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from kurt2rt.channel.protocol.limits import VERSION
from tests.channel import device_by_the_book
from tests.channel.device_by_the_book import Device
from tests.channel.jumping_loop import run_jumping
from tests.channel.robot_at_work import RobotAtWork, journal_of, robot_at_work

CHANGED, CONFLICT, BAD_REQUEST, NOT_FOUND = 0x44, 0x89, 0x80, 0x84


@asynccontextmanager
async def the_robot_and_its_device(folder: Path) -> AsyncIterator[tuple[RobotAtWork, Device]]:
    """Start the robot; its device has sent nothing yet."""
    async with robot_at_work(folder) as at_work, Device(at_work.pairing.device.folder, at_work.port) as device:
        yield at_work, device


def a_command() -> bytes:
    return secrets.token_bytes(8)


def test_the_device_uses_no_library_of_the_robot() -> None:
    tree = ast.parse(Path(device_by_the_book.__file__).read_text(encoding="utf-8"))
    imported = {name.name for node in ast.walk(tree) if isinstance(node, ast.Import) for name in node.names}
    imported |= {node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert not {name for name in imported if name.split(".")[0] in ("kurt2rt", "hal", "tests", "aiocoap")}


def test_it_says_hello_looks_teaches_and_stops(tmp_path: Path) -> None:
    async def story() -> None:
        async with the_robot_and_its_device(tmp_path) as (_, device):
            hello = (await device.ask("/hello", [])).body
            assert device.challenged == 1  # the robot was just started
            assert hello["v"] == VERSION
            assert "forward" in hello["actions"]

            looking = await device.look()
            seen = [await looking.picture() for _ in range(5)]
            assert [each["t"] for each in seen] == sorted({each["t"] for each in seen})
            assert {each["b"] for each in seen} == {hello["boot"]}
            assert seen[-1]["by"] == "unknown"

            boot = hello["boot"]
            taken = await device.ask("/take", [boot, a_command(), seen[-1]["t"]])
            assert (taken.code, taken.body["ok"], taken.body["text"]) == (CHANGED, True, "local teaches")
            assert "row" not in taken.body
            lesson, tick = a_command(), (await looking.picture())["t"]
            taught = await device.ask("/answer", [boot, lesson, tick, "forward", None, "basic", False])
            assert (taught.code, taught.body["row"]) == (CHANGED, 1)
            again = await device.ask("/answer", [boot, lesson, tick, "forward", None, "basic", False])
            assert again.code == CHANGED
            (told,) = (await device.ask("/lessons", [5])).body["lessons"]
            assert (told[0], told[6]) == (f"local-{lesson.hex()}", False)

            while (await looking.picture())["by"] != "rla":
                assert (await device.ask("/watch", [boot, (await looking.picture())["t"]])).body.keys() == {"t"}
            stopped = await device.ask("/stop", [a_command(), None])
            assert (stopped.code, stopped.body["ok"]) == (CHANGED, True)
            assert (await looking.picture())["by"] == "stopped"

            refused = await device.ask("/resume", [b"else", a_command(), (await looking.picture())["t"]])
            assert (refused.code, refused.body["why"]) == (CONFLICT, "boot")
            nonsense = await device.ask("/reward", [boot, a_command(), 0, 7, None])
            assert (nonsense.code, nonsense.body["why"]) == (BAD_REQUEST, "malformed")
            real = await device.ask("/world", [])
            assert (real.code, real.body["why"]) == (NOT_FOUND, "refused")

    run_jumping(story)
    (event,) = journal_of(tmp_path)
    assert event.origin.teacher == "local"


@pytest.mark.parametrize("confirms", [True, False])
def test_device_by_the_book_confirms_and_keeps_observing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, confirms: bool
) -> None:
    if not confirms:
        put = Device._put
        monkeypatch.setattr(Device, "_put", lambda self, data: put(self, data) if data[1] else None)

    async def story() -> None:
        async with the_robot_and_its_device(tmp_path) as (at_work, device):
            looking = await device.look()
            while at_work.tick < 1200:  # given up after 7.8 s at most, and asked for again a second later
                await looking.picture()
            # One registration and its challenge; without confirmations there are more.
            assert (looking.begun > 2) is not confirms
            if confirms:
                assert device.confirmed > 5
                assert at_work.channel.site.observers == 1

    run_jumping(story)
