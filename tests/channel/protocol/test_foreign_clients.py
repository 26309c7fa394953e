"""Clients that are not ours: the robot speaks CoAP, Observe and OSCORE as the standards have them."""

import asyncio
import json
import secrets
import shutil
import subprocess
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import aiocoap
import anyio
import pytest
from aiocoap import oscore

from kurt2rt.channel.protocol.codec import decode_answer, decode_state, encode_request
from kurt2rt.channel.protocol.requests import TakeRequest
from kurt2rt.channel.security.pairing import Pairing
from kurt2rt.core.outcome import ResultCode
from tests.channel.robot_at_work import RobotAtWork, robot_at_work
from tests.patience import PATIENCE_S

_NAMES = ("coap-client", "coap-client-notls", "coap-client-openssl", "coap-client-gnutls")
_SECONDS = "5"
_OSCORE_SWITCH = "-E "


@pytest.fixture
def oscore_client() -> str:
    """Client of libcoap from 4.3.5 on, if built with OSCORE; Debian's is older."""
    for found in filter(None, map(shutil.which, _NAMES)):
        usage = subprocess.run([found, "-?"], capture_output=True, text=True, check=False)
        if _OSCORE_SWITCH in usage.stdout + usage.stderr:
            return found
    pytest.skip("no coap-client with OSCORE on PATH (libcoap 4.3.5 or later, built with OSCORE)")


async def said(client: str, *arguments: str) -> tuple[str, str]:
    """Return standard output and standard error of the client."""
    with anyio.fail_after(PATIENCE_S):
        done = await anyio.run_process([client, "-B", _SECONDS, *arguments], check=False)
    return done.stdout.decode(errors="replace"), done.stderr.decode(errors="replace")


def address(at_work: RobotAtWork, path: str) -> str:
    return f"coap://127.0.0.1:{at_work.port}{path}"


@asynccontextmanager
async def _aiocoap_client(at_work: RobotAtWork, pairing: Pairing) -> AsyncIterator[Any]:
    """OSCORE client of aiocoap with its own context, on the unchanged folder of the device."""
    client = await aiocoap.Context.create_client_context(transports=["oscore", "udp6"])
    keys = oscore.FilesystemSecurityContext(str(pairing.device.folder))
    client.client_credentials[address(at_work, "/*")] = keys
    try:
        yield client
    finally:
        await client.shutdown()
        keys._destroy()  # else it writes when it is collected, to a folder that has gone


async def test_aiocoap_oscore_client_observes_and_commands(tmp_path: Path) -> None:
    async with robot_at_work(tmp_path) as at_work, _aiocoap_client(at_work, at_work.pairing) as client:
        with anyio.fail_after(PATIENCE_S):
            response = await client.request(aiocoap.Message(code=aiocoap.GET, uri=address(at_work, "/state"))).response
            state = decode_state(response.payload)
            assert (response.code, state.teacher) == (aiocoap.CONTENT, None)

            looking = client.request(aiocoap.Message(code=aiocoap.GET, uri=address(at_work, "/state"), observe=0))
            ticks = [decode_state((await looking.response).payload).tick]
            async for picture in looking.observation:
                ticks.append(decode_state(picture.payload).tick)
                if len(ticks) == 10:
                    break
            assert ticks == sorted(set(ticks))

            take = TakeRequest(boot=state.boot, command_id=secrets.token_bytes(8), seen=ticks[-1])
            taken = await client.request(
                aiocoap.Message(
                    code=aiocoap.POST,
                    uri=address(at_work, "/take"),
                    payload=encode_request(take),
                    content_format=60,
                )
            ).response
            assert (taken.code, decode_answer(taken.payload)["code"]) == (aiocoap.CHANGED, ResultCode.TAKEN)
            assert at_work.runtime.handler.authority.teacher == "local"
            looking.observation.cancel()


@pytest.fixture
def conf_of(tmp_path: Path) -> Callable[[Pairing], Path]:
    """Write a pairing in the form of libcoap."""

    def write(pairing: Pairing) -> Path:
        read = {
            key: value
            for name in ("settings.json", "secret.json")
            for key, value in json.loads((pairing.device.folder / name).read_text(encoding="utf-8")).items()
        }
        keys = {"master_secret": "secret_hex", "master_salt": "salt_hex", "sender_id": "sender-id_hex"}
        lines = [f'{key},hex,"{read[mine]}"' for key, mine in {**keys, "recipient_id": "recipient-id_hex"}.items()]
        path = tmp_path / "oscore.conf"
        path.write_text("\n".join((*lines, "replay_window,integer,32", "")), encoding="utf-8")
        return path

    return write


async def test_libcoap_with_oscore_looks_observes_and_commands(
    oscore_client: str, conf_of: Callable[[Pairing], Path], tmp_path: Path
) -> None:
    async with robot_at_work(tmp_path) as at_work:
        switch = ("-E", f"{conf_of(at_work.pairing)},{tmp_path / 'sequence'}")
        out = tmp_path / "state"
        await said(oscore_client, *switch, "-o", str(out), address(at_work, "/state"))
        state = decode_state(out.read_bytes())
        looked: list[int] = []
        async with asyncio.TaskGroup() as tasks:
            tasks.create_task(_noted(at_work, looked))
            _, complaints = await said(oscore_client, *switch, "-s", "2", "-o", str(out), address(at_work, "/state"))
            looked.append(-1)
        assert max(looked) == 1
        assert complaints == ""

        body = tmp_path / "take"
        body.write_bytes(encode_request(TakeRequest(state.boot, secrets.token_bytes(8), at_work.tick)))
        await said(oscore_client, *switch, "-m", "post", "-t", "60", "-f", str(body), address(at_work, "/take"))
        assert at_work.runtime.handler.authority.teacher == "local"


async def _noted(at_work: RobotAtWork, looked: list[int]) -> None:
    while -1 not in looked:
        looked.append(at_work.channel.site.observers)
        await anyio.sleep(0.05)
