"""Robot and teacher on a machine without IPv6 reach each other over IPv4."""

import socket
from pathlib import Path

import anyio
import pytest

from kurt2rt.channel.protocol.schema import ChannelError
from kurt2rt.channel.security.pairing import pair
from kurt2rt.channel.server.endpoint import open_endpoint
from kurt2rt.teacher.client.transport import open_requests
from tests.channel.missing_family import remove_family
from tests.channel.server.test_endpoint import Site, must_answer


@pytest.mark.parametrize("sockets_open", [False, True])
@pytest.mark.parametrize(("listens", "asked"), [("::", "127.0.0.1"), ("127.0.0.1", "127.0.0.1"), ("::", "127.0.0.2")])
async def test_endpoint_without_ipv6_answers_over_ipv4(
    monkeypatch: pytest.MonkeyPatch, listens: str, asked: str, sockets_open: bool
) -> None:
    remove_family(monkeypatch, socket.AF_INET6, sockets_open=sockets_open)
    await must_answer(listens, asked)


async def test_endpoint_without_ipv6_has_no_ipv6_address(monkeypatch: pytest.MonkeyPatch) -> None:
    remove_family(monkeypatch, socket.AF_INET6)
    with pytest.raises(ChannelError, match="::1 is not an address of this machine"):
        await open_endpoint(Site(), "::1", 0)


async def test_teacher_without_ipv6_notices_that_no_robot_listens(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    remove_family(monkeypatch, socket.AF_INET6)
    device = pair(tmp_path / "teachers", tmp_path / "devices", "phone").device
    requests = await open_requests(device.folder, "127.0.0.1", 1)
    exchange = requests.post("/take", b"", lambda _: None)
    with anyio.fail_after(60.0):
        while not exchange.ended:  # noqa: ASYNC110 - the kernel's report sets no event
            await anyio.sleep(0.01)
    assert "Network error" in requests.trouble
    await requests.close()
