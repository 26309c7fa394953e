"""Limit of amplification: three times the bytes of a request, because its address may be forged."""

import asyncio
import random
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import aiocoap
import pytest

from tests.channel.hostile_datagrams import UNLIMITED, HostileDatagrams, drained, outside
from tests.channel.jumping_loop import run_jumping
from tests.channel.robot_at_work import RobotAtWork, robot_at_work

_AT_MOST = 3
_RETRIES_S = 4.0
"""Time after which an unconfirmed message was sent again: 2 to 3 s (RFC 7252, 4.8)."""


def discovery(kind: Any, token: bytes, number: int, **block: Any) -> bytes:
    message = aiocoap.Message(code=aiocoap.GET, **block)
    message.opt.uri_path = (".well-known", "core")
    message.mtype, message.token, message.mid = kind, token, number
    data: bytes = message.encode()
    return data


async def answered(at_work: RobotAtWork, datagrams: list[bytes]) -> list[int]:
    """Bytes that came back for each, which the address did not confirm."""
    gate: Any = at_work.channel.endpoint._filter
    gate._strangers = UNLIMITED
    with ExitStack() as opened:
        senders = [opened.enter_context(outside()) for _ in datagrams]
        for sender, datagram in zip(senders, datagrams, strict=True):
            sender.sendto(datagram, ("127.0.0.1", at_work.port))
            await asyncio.sleep(0.01)
        await asyncio.sleep(_RETRIES_S)
        return [sum(map(len, drained(sender))) for sender in senders]


@pytest.mark.parametrize("kind", [aiocoap.CON, aiocoap.NON], ids=["con", "non"])
def test_discovery_answers_at_most_three_times_the_bytes(tmp_path: Path, kind: Any) -> None:
    async def story() -> None:
        async with robot_at_work(tmp_path) as at_work:
            requests = [discovery(kind, bytes(length), 7 + length) for length in range(9)]
            requests += [
                discovery(kind, b"", 100 + n, block2=(n, False, exponent)) for n, exponent in enumerate(range(7))
            ]
            came = await answered(at_work, requests)
            assert all(came)
            assert max(back / len(sent) for back, sent in zip(came, requests, strict=True)) <= _AT_MOST

    run_jumping(story)


def test_strangers_get_at_most_three_times_their_bytes(tmp_path: Path) -> None:
    async def story() -> None:
        async with robot_at_work(tmp_path) as at_work:
            chance, hostile = random.Random(2004), HostileDatagrams(2004, lambda: (b"boot", 0))
            captured = [discovery(aiocoap.CON, chance.randbytes(4), number) for number in range(20)]
            datagrams = [bytes((0x40, 0, 1, 2))]  # a ping
            datagrams += [hostile.datagram(captured) for _ in range(150)]
            datagrams += [hostile.mutated(chance.choice(captured)) for _ in range(150)]
            datagrams = [each for each in datagrams if each]
            came = await answered(at_work, datagrams)
            assert sum(back > 0 for back in came) > 50
            worst = max(zip(came, datagrams, strict=True), key=lambda pair: pair[0] / len(pair[1]))
            assert worst[0] <= _AT_MOST * len(worst[1]), worst

    run_jumping(story)
