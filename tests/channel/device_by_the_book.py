"""A teacher's device that uses nothing but docs/the-wire.md: no CoAP library, no OSCORE library, nothing of kurt2rt.

What it needs and does not find written there is missing there.
"""

import asyncio
import fcntl
import json
import os
import secrets
import socket
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import cbor2
from cryptography.exceptions import InvalidTag
from cryptography.hazmat.primitives.ciphers.aead import AESCCM
from cryptography.hazmat.primitives.hashes import SHA256
from cryptography.hazmat.primitives.kdf.hkdf import HKDF

CON, NON, ACK, RST = range(4)
GET, POST, FETCH, UNAUTHORIZED = 0x01, 0x02, 0x05, 0x81
OBSERVE, OSCORE, URI_PATH, CONTENT_FORMAT, ECHO = 6, 9, 11, 12, 252
CBOR = b"\x3c"
_RESERVED = 1000
_AGAIN_S = 0.1
_PATIENCE_S = 3.5


def derived(secret: bytes, salt: bytes, of: bytes, what: str, length: int) -> bytes:
    info = cbor2.dumps([of, None, 10, what, length])
    return HKDF(SHA256(), length, salt, info).derive(secret)


class Numbers:
    """Sequence numbers of the device's folder."""

    def __init__(self, folder: Path, now: Callable[[], float]) -> None:
        self._folder = folder
        self._lock = os.open(folder / "lock", os.O_RDWR | os.O_CREAT, 0o600)
        fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        stored = json.loads((folder / "sequence.json").read_text(encoding="utf-8"))["next-to-send"]
        paired_s = json.loads((folder / "settings.json").read_text(encoding="utf-8"))["paired-at"]
        by_time = min(max(0, int((now() - paired_s) * 1000)), 2**39)
        self.next: int = max(stored, by_time)
        self._stored = self.next

    def take(self) -> bytes:
        """Return the next number in the form of the option."""
        if self.next >= self._stored:
            self._store(self.next + _RESERVED)
        number, self.next = self.next, self.next + 1
        return number.to_bytes(max(1, (number.bit_length() + 7) // 8), "big")

    def close(self) -> None:
        self._store(self.next)
        os.close(self._lock)

    def _store(self, up_to: int) -> None:
        unborn = self._folder / "sequence.new"
        with unborn.open("w", encoding="utf-8") as file:
            json.dump({"next-to-send": up_to, "received": "unknown"}, file)
            file.flush()
            os.fsync(file.fileno())
        unborn.rename(self._folder / "sequence.json")
        folder = os.open(self._folder, os.O_RDONLY)
        os.fsync(folder)
        os.close(folder)
        self._stored = up_to


def options_encoded(options: Sequence[tuple[int, bytes]]) -> bytes:
    encoded, last = b"", 0
    for number, value in sorted(options, key=lambda option: option[0]):
        delta, more_delta = _nibble(number - last)
        length, more_length = _nibble(len(value))
        encoded += bytes((delta << 4 | length,)) + more_delta + more_length + value
        last = number
    return encoded


def _nibble(value: int) -> tuple[int, bytes]:
    if value < 13:
        return value, b""
    if value < 269:
        return 13, bytes((value - 13,))
    return 14, (value - 269).to_bytes(2, "big")


def options_and_body(data: bytes) -> tuple[dict[int, bytes], bytes]:
    options, number, at = {}, 0, 0
    while at < len(data) and data[at] != 0xFF:
        nibbles, at = (data[at] >> 4, data[at] & 15), at + 1
        values = []
        for nibble in nibbles:
            more = {13: 1, 14: 2}.get(nibble, 0)
            values.append(int.from_bytes(data[at : at + more], "big") + {13: 13, 14: 269}[nibble] if more else nibble)
            at += more
        number += values[0]
        options[number] = data[at : at + values[1]]
        at += values[1]
    return options, data[at + 1 :]


@dataclass(frozen=True)
class Message:
    """A CoAP message."""

    kind: int
    code: int
    number: int
    token: bytes
    options: dict[int, bytes]
    body: bytes

    @classmethod
    def parse(cls, data: bytes) -> Self:
        ends = 4 + (data[0] & 15)
        options, body = options_and_body(data[ends:])
        return cls(data[0] >> 4 & 3, data[1], int.from_bytes(data[2:4], "big"), data[4:ends], options, body)


@dataclass(frozen=True)
class Answer:
    """Decrypted answer of the robot."""

    code: int
    options: dict[int, bytes]
    body: Any
    number: int | None
    """The robot's own sequence number, if it used one."""


@dataclass
class _Asked:
    """A request that waits for what comes under its token."""

    number: bytes
    answers: asyncio.Queue[Answer]


class Device:
    """A device that is paired; use it as an asynchronous context."""

    def __init__(self, folder: Path, port: int | None = None, now: Callable[[], float] = time.time) -> None:
        told = json.loads((folder / "device.json").read_text(encoding="utf-8"))
        settings = json.loads((folder / "settings.json").read_text(encoding="utf-8"))
        keys = json.loads((folder / "secret.json").read_text(encoding="utf-8"))
        secret, salt = bytes.fromhex(keys["secret_hex"]), bytes.fromhex(keys["salt_hex"])
        self.id, self.robots_id = (bytes.fromhex(settings[f"{whose}-id_hex"]) for whose in ("sender", "recipient"))
        self._seal = AESCCM(derived(secret, salt, self.id, "Key", 16), tag_length=8)
        self._open = AESCCM(derived(secret, salt, self.robots_id, "Key", 16), tag_length=8)
        self._iv = derived(secret, salt, b"", "IV", 13)
        self.numbers = Numbers(folder, now)
        self._robot = (told["host"], port or told["port"])
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        self._socket.connect(self._robot)
        self._waiting: dict[bytes, _Asked] = {}
        self._message_id = secrets.randbelow(2**16)
        self.challenged = 0
        """Echos of the robot that were answered."""
        self.confirmed = 0
        """Pictures that wanted an ACK and got it."""

    async def __aenter__(self) -> Self:
        self._reading = asyncio.create_task(self._read())
        return self

    async def __aexit__(self, *_: object) -> None:
        self._reading.cancel()
        self._socket.close()
        self.numbers.close()

    async def ask(self, path: str, body: list[Any]) -> Answer:
        """Say something until it is answered."""
        queue: asyncio.Queue[Answer] = asyncio.Queue()
        async with asyncio.timeout(_PATIENCE_S):
            echo: bytes | None = None
            while True:
                self._send(path, body, queue, echo=echo)
                try:
                    answer = await asyncio.wait_for(queue.get(), _AGAIN_S)
                except TimeoutError:
                    continue
                if answer.code != UNAUTHORIZED or ECHO not in answer.options:
                    return answer
                echo = answer.options[ECHO]
                self.challenged += 1

    async def look(self) -> "Looking":
        """Observe the pictures."""
        looking = Looking(self)
        await looking.begin()
        return looking

    def _nonce(self, of: bytes, number: bytes) -> bytes:
        names = bytes((len(of),)) + of.rjust(7, b"\0") + number.rjust(5, b"\0")
        return bytes(a ^ b for a, b in zip(self._iv, names, strict=True))

    def _aad(self, number: bytes) -> bytes:
        return cbor2.dumps(["Encrypt0", b"", cbor2.dumps([1, [10], self.id, number, b""])])

    def _send(self, path: str, body: list[Any] | None, queue: asyncio.Queue[Answer], *, echo: bytes | None) -> bytes:
        """Send a request, which observes if it has no body; its token."""
        observes = body is None
        kind, code = (CON, GET) if observes else (NON, POST)
        number, token = self.numbers.take(), secrets.token_bytes(4)
        inner = [(URI_PATH, part.encode()) for part in path.strip("/").split("/")]
        outer = [(OSCORE, bytes((0x08 | len(number),)) + number + self.id)]
        if observes:
            inner.append((OBSERVE, b""))  # zero has no bytes
            outer.append((OBSERVE, b""))
        if echo is not None:
            inner.append((ECHO, echo))
        plain = b""
        if body is not None:
            inner.append((CONTENT_FORMAT, CBOR))
            plain = b"\xff" + cbor2.dumps(body)
        plain = bytes((code,)) + options_encoded(inner) + plain
        sealed = self._seal.encrypt(self._nonce(self.id, number), plain, self._aad(number))
        self._message_id = (self._message_id + 1) % 2**16
        header = bytes((0x40 | kind << 4 | len(token), FETCH if observes else POST))
        self._waiting[token] = _Asked(number, queue)
        self._put(header + self._message_id.to_bytes(2, "big") + token + options_encoded(outer) + b"\xff" + sealed)
        return token

    def forget(self, token: bytes) -> None:
        self._waiting.pop(token, None)

    def _put(self, datagram: bytes) -> None:
        try:
            self._socket.send(datagram)
        except ConnectionRefusedError:  # of the datagram before: the robot is off
            return

    async def _read(self) -> None:
        loop = asyncio.get_running_loop()
        while True:
            try:
                self._hear(Message.parse(await loop.sock_recv(self._socket, 65_507)))
            except ConnectionRefusedError:
                continue

    def _hear(self, message: Message) -> None:
        asked = self._waiting.get(message.token)
        if message.kind == CON:
            # What no call waits for any more is refused, so that the robot does not send it again.
            self._put(bytes((0x40 | (ACK if asked else RST) << 4, 0)) + message.number.to_bytes(2, "big"))
            self.confirmed += asked is not None
        if asked is None or OSCORE not in message.options:
            return
        option = message.options[OSCORE]
        number = option[1 : 1 + (option[0] & 7)] if option else b""
        nonce = self._nonce(self.robots_id, number) if number else self._nonce(self.id, asked.number)
        try:
            plain = self._open.decrypt(nonce, message.body, self._aad(asked.number))
        except InvalidTag:
            return
        options, body = options_and_body(plain[1:])
        told = cbor2.loads(body) if body else None
        asked.answers.put_nowait(Answer(plain[0], options, told, int.from_bytes(number, "big") if number else None))


class Looking:
    """An observation of /state; begun again when the pictures cease."""

    def __init__(self, device: Device) -> None:
        self._device = device
        self._queue: asyncio.Queue[Answer] = asyncio.Queue()
        self._token = b""
        self._newest = -1
        self.begun = 0
        """Registrations that were sent."""

    async def begin(self, echo: bytes | None = None) -> None:
        self._device.forget(self._token)
        self._queue = asyncio.Queue()
        self._newest = -1
        self.begun += 1
        self._token = self._device._send("/state", None, self._queue, echo=echo)

    async def picture(self) -> dict[str, Any]:
        """Return the next state."""
        while True:
            try:
                answer = await asyncio.wait_for(self._queue.get(), 1.0)
            except TimeoutError:
                await self.begin()
                continue
            if answer.code == UNAUTHORIZED and ECHO in answer.options:
                self._device.challenged += 1
                await self.begin(answer.options[ECHO])
                continue
            if answer.number is not None:
                if answer.number <= self._newest:
                    continue
                self._newest = answer.number
            told: dict[str, Any] = answer.body
            return told
