"""Clients that are not ours: the robot speaks CoAP, Observe and OSCORE as the standards have them."""

import secrets
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import aiocoap
import anyio
from aiocoap import oscore

from kurt2rt.channel.protocol.codec import decode_answer, decode_state, encode_request
from kurt2rt.channel.protocol.request_types import tick_request
from kurt2rt.channel.security.pairing import Pairing
from kurt2rt.core.outcome import ResultCode
from kurt2rt.core.teaching.commands import Take
from tests.channel.robot_at_work import RobotAtWork, robot_at_work
from tests.patience import PATIENCE_S


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

            take = tick_request(Take, state.boot, secrets.token_bytes(8), ticks[-1])
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
