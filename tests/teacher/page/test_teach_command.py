"""`kurt2rt teach` as a process of its own."""

import http.client
import json
import signal
import socket
from pathlib import Path
from urllib.parse import urlsplit

from websockets.sync.client import connect

from kurt2rt.channel.security.pairing import pair, revoke
from tests.cli.helpers import running
from tests.patience import PATIENCE_S

HERE = ("--page-address", "127.0.0.1")
"""A phone is told this address also where this machine is in no network."""


def free_udp_port() -> int:
    """Return a free UDP port."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


def cookie_of(address: str) -> str:
    """Open the address that was printed, as a browser does."""
    parts = urlsplit(address)
    connection = http.client.HTTPConnection(parts.netloc, timeout=PATIENCE_S)
    try:
        connection.request("GET", f"{parts.path}?{parts.query}")
        response = connection.getresponse()
        response.read()
        assert response.status == 200
        return str(response.headers["Set-Cookie"]).split(";")[0]
    finally:
        connection.close()


def test_the_page_says_that_there_is_no_robot_and_ends_when_told(tmp_path: Path) -> None:
    port = free_udp_port()
    with running("teach", "--page-port", "0", "--port", str(port), folder=tmp_path) as page:
        address = page.wait_for("http://").strip()
        assert address.startswith("http://127.0.0.1:")
        at = urlsplit(address).netloc
        headers = {"Cookie": cookie_of(address), "Origin": f"http://{at}"}
        with connect(f"ws://{at}/robot", additional_headers=headers, proxy=None, open_timeout=PATIENCE_S) as websocket:
            said: dict[str, str] = {}
            while said.get("kind") != "silent":
                said = json.loads(websocket.recv(timeout=PATIENCE_S))
        assert f"127.0.0.1:{port}" in said["text"]
        ended = page.end(signal.SIGTERM)
    assert ended.exit_code == 0
    assert ended.err == ""


def test_a_pairing_that_is_revoked_ends_its_page(tmp_path: Path) -> None:
    teachers, devices = tmp_path / "var" / "teachers", tmp_path / "var" / "devices"
    pair(teachers, devices, "phone")
    with running("teach", "--device", "phone", "--page-port", "0", *HERE, folder=tmp_path) as page:
        address = urlsplit(page.wait_for("http://").strip())
        cookie_of(address._replace(netloc=f"127.0.0.1:{address.port}").geturl())  # it is served, also on loopback
        revoke(teachers, devices, "phone")
        assert page.process.wait(timeout=PATIENCE_S) == 2
        assert page.process.stderr is not None
        (line,) = page.process.stderr.read().splitlines()
    assert line.startswith("kurt2rt: phone: ")
    assert line.endswith("kurt2rt pair phone")
