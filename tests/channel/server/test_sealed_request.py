"""The tag is checked before aiocoap decodes a datagram; no datagram that aiocoap would take is lost by it."""

import random

import aiocoap
import pytest
from aiocoap import oscore
from aiocoap.message import Direction
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kurt2rt.channel.security.oscore_context import OscoreContext
from kurt2rt.channel.server.datagram_filter import may_be_request
from kurt2rt.channel.server.sealed_request import SealedRequest
from tests.channel.hostile_datagrams import HostileDatagrams
from tests.channel.sides import Sides

_ALLOWED = settings(suppress_health_check=[HealthCheck.function_scoped_fixture])


def stop() -> aiocoap.Message:
    return aiocoap.Message(code=aiocoap.POST, uri_path=("stop",), payload=b"\x82\x48identity\xf6")


def aiocoap_takes(robot: OscoreContext, data: bytes) -> bool:
    """Return whether aiocoap finds the tag valid; a copy counts too."""
    try:
        message = aiocoap.Message.decode(data)
        message.direction = Direction.INCOMING
        if oscore.verify_start(message).get(oscore.COSE_KID) != robot.recipient_id:
            return False
        robot.unprotect(message)
    except (oscore.ReplayError, oscore.ReplayErrorWithEcho):
        return True
    except Exception:  # noqa: BLE001 - forged bytes make the library raise many things
        return False
    return True


@_ALLOWED
@given(
    observe=st.none() | st.just(0),
    host=st.none() | st.text("abc.", min_size=1, max_size=255),
    token=st.binary(max_size=8),
    payload=st.binary(max_size=400),
)
def test_sealed_request_of_device_fits_its_key(
    sides: Sides, observe: int | None, host: str | None, token: bytes, payload: bytes
) -> None:
    message = aiocoap.Message(code=aiocoap.GET, uri_path=("state",), payload=payload)
    message.opt.observe, message.opt.uri_host = observe, host
    number = sides.device.sender_sequence_number
    sealed = SealedRequest.parse(sides.datagram(message, token))
    assert sealed is not None
    assert (sealed.kid, sealed.kid_context, sealed.number) == (sides.device.sender_id, None, number)
    assert sealed.fits(sides.robot)
    assert not sealed.fits(sides.device)


@pytest.mark.parametrize("draws", [3000, pytest.param(300_000, marks=pytest.mark.deep)])
def test_changed_datagrams_pass_only_with_a_whole_seal(sides: Sides, draws: int) -> None:
    chance, hostile = random.Random(2004), HostileDatagrams(2004, lambda: (b"boot", 0))
    captured = [sides.datagram(stop()) for _ in range(5)]
    seals = {SealedRequest.parse(data) for data in captured}
    passed = refused = 0
    for _ in range(draws):
        data = hostile.mutated(chance.choice(captured))
        if not may_be_request(data):
            continue
        sealed, known = SealedRequest.parse(data), aiocoap_takes(sides.robot, data)
        if sealed is None or sealed.kid != sides.robot.recipient_id or not sealed.fits(sides.robot):
            assert not known, data.hex()
            refused += 1
        else:
            assert sealed in seals
            passed += known
    assert passed > draws / 20
    assert refused > draws / 20


@pytest.mark.parametrize(
    ("rest", "why"),
    [
        ("", "no option"),
        ("9109", "no payload"),
        ("90ff00", "an empty option: no key id, no number"),
        ("9108ff00", "no number"),
        ("910fff00", "shorter than its number"),
        ("9609", "ends within the option"),
        ("fd", "ends within a length"),
        ("9f", "a reserved length"),
        ("950e00aabbccff00", "a number of six bytes"),
        ("952900aabbccff00", "a reserved bit"),
        ("921900ff00", "a key context without its length"),
        ("93190005ff00", "a key context that is longer than the option"),
    ],
)
def test_sealed_request_incomplete_is_none(rest: str, why: str) -> None:
    assert SealedRequest.parse(bytes((0x50, 2, 0, 1)) + bytes.fromhex(rest)) is None, why
