"""Both sides of a pairing in one process, and what goes over the wire between them."""

from pathlib import Path
from typing import Any

import aiocoap
from aiocoap import oscore
from aiocoap.message import Direction

from kurt2rt.channel.security.oscore_context import OscoreContext
from kurt2rt.channel.security.pairing import Pairing


class Sides:
    """A device and its robot."""

    def __init__(self, pairing: Pairing) -> None:
        self.device, self.robot = OscoreContext(pairing.device.folder), OscoreContext(pairing.teacher)

    def datagram(self, message: aiocoap.Message, token: bytes = b"12345678") -> bytes:
        """Return a request of the device in its form on the wire."""
        outer, _ = self.device.protect(message)
        outer.mid, outer.mtype, outer.token = 7, aiocoap.NON, token
        data: bytes = outer.encode()
        return data

    def close(self) -> None:
        self.device.close()
        self.robot.close()


def carried(message: Any) -> Any:
    """Return the message in the form in which the other side gets it."""
    message.mid, message.mtype = 7, aiocoap.NON
    received = aiocoap.Message.decode(message.encode())
    received.direction = Direction.INCOMING
    return received


def ask(device: OscoreContext, robot: OscoreContext, text: str, *, echo: bytes | None = None) -> str:
    """Send a request that the robot unprotects; returns what it reads."""
    request = aiocoap.Message(code=aiocoap.POST, payload=text.encode(), uri_path=("lesson",), echo=echo)
    protected, _ = device.protect(request)
    unprotected, _ = robot.unprotect(carried(protected))
    payload: bytes = unprotected.payload
    return payload.decode()


def ask_until_fresh(device: OscoreContext, robot: OscoreContext, text: str) -> str:
    """Ask like `ask`, with the device's answer to the robot's challenge (RFC 8613, B.1.2)."""
    request = aiocoap.Message(code=aiocoap.POST, payload=text.encode(), uri_path=("lesson",))
    protected, request_id = device.protect(request)
    try:
        unprotected, _ = robot.unprotect(carried(protected))
    except oscore.ReplayErrorWithEcho as challenge:
        answer, _ = device.unprotect(carried(challenge.to_message()), request_id)
        return ask(device, robot, text, echo=answer.opt.echo)
    payload: bytes = unprotected.payload
    return payload.decode()


def answer_challenge(device: OscoreContext, robot: OscoreContext) -> None:
    """First contact after a start of the robot: from now on it knows that the device's messages are new."""
    ask_until_fresh(device, robot, "hello")


def header_of(context: OscoreContext) -> dict[int, bytes]:
    """Return the OSCORE header, in aiocoap's form, of a request of this context."""
    protected, _ = context.protect(aiocoap.Message(code=aiocoap.POST, uri_path=("hello",)))
    header: dict[int, bytes] = oscore.verify_start(carried(protected))
    return header


def sequence_of(folder: Path) -> str:
    """Return the stored state of the context."""
    return (folder / "sequence.json").read_text(encoding="utf-8")
