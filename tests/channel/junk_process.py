"""Datagrams at a robot, a child of test_flood.py: until SIGTERM.

Arguments: port of the robot, datagrams a second, and a key id in hexadecimal for requests that no key made; without it
all sorts of junk.
"""

import random
import socket
import sys
import time

from tests.channel.hostile_datagrams import HostileDatagrams

_BURSTS_PER_S = 100
_KINDS = 4_000
_SENDERS = 4
_UNKNOWN = "aabbcc"


def forged(chance: random.Random, kid: bytes) -> bytes:
    """Protected by a key that no device has."""
    option = b"\x0b" + chance.randbytes(3) + kid
    return bytes((0x58, 0x02, 0, 0)) + bytes(8) + bytes((0x90 | len(option),)) + option + b"\xff" + chance.randbytes(30)


def junk_of(port: int, chance: random.Random, kid: str) -> list[bytes]:
    if kid:
        return [forged(chance, bytes.fromhex(kid)) for _ in range(_KINDS)]
    hostile = HostileDatagrams(port, lambda: (b"boot", 0))
    sealed = [forged(chance, bytes.fromhex(_UNKNOWN)) for _ in range(_KINDS // 4)]
    return sealed + [hostile.datagram(sealed) for _ in range(_KINDS)]


def flood(port: int, per_s: int, kid: str) -> None:
    chance = random.Random(port)
    junk = junk_of(port, chance, kid)
    outs = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(_SENDERS)]
    print("flooding", flush=True)
    due_s = time.monotonic()
    while True:
        for _ in range(per_s // _BURSTS_PER_S):
            datagram = chance.choice(junk)
            # A message id of its own, so that each is a new one.
            chance.choice(outs).sendto(datagram[:2] + chance.randbytes(2) + datagram[4:], ("127.0.0.1", port))
        due_s += 1 / _BURSTS_PER_S
        time.sleep(max(0.0, due_s - time.monotonic()))


if __name__ == "__main__":
    flood(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3])
