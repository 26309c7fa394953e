"""`kurt2rt teach` as a process of its own."""

import signal
import socket
from pathlib import Path

from kurt2rt.channel.security.pairing import pair, revoke
from tests.cli.helpers import running
from tests.patience import PATIENCE_S
from tests.teacher.page.test_device_pages import come_in, websocket
from tests.teacher.page.test_served_page import hear

HERE = ("--page-address", "127.0.0.1")
"""A phone is told this address also where this machine is in no network."""


def free_udp_port() -> int:
    """Return a free UDP port."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


async def test_the_page_says_that_there_is_no_robot_and_ends_when_told(tmp_path: Path) -> None:
    port = free_udp_port()
    with running("teach", "--page-port", "0", "--port", str(port), folder=tmp_path) as page:
        address = page.wait_for("http://").strip()
        assert address.startswith("http://127.0.0.1:")
        async with websocket(await come_in(address)) as link:
            said = await hear(link, "silent")
        assert f"127.0.0.1:{port}" in said["text"]
        ended = page.end(signal.SIGTERM)
    assert ended.exit_code == 0
    assert ended.err == ""


async def test_a_pairing_that_is_revoked_ends_its_page(tmp_path: Path) -> None:
    teachers, devices = tmp_path / "var" / "teachers", tmp_path / "var" / "devices"
    pair(teachers, devices, "phone")
    with running("teach", "--device", "phone", "--page-port", "0", *HERE, folder=tmp_path) as page:
        await come_in(page.wait_for("http://").strip())
        revoke(teachers, devices, "phone")
        assert page.process.wait(timeout=PATIENCE_S) == 2
        assert page.process.stderr is not None
        (line,) = page.process.stderr.read().splitlines()
    assert line.startswith("kurt2rt: phone: ")
    assert line.endswith("kurt2rt pair phone")
