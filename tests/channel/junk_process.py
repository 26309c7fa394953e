"""2000 datagrams a second at a robot, a child of test_flood.py: until SIGTERM.

Arguments: port of the robot.
"""

import random
import socket
import sys
import time

from tests.channel.mischief import Mischief

_PER_BURST, _BURSTS_PER_S = 20, 100
_KINDS = 4_000
_SENDERS = 4


def flood(port: int) -> None:
    chance = random.Random(port)
    mischief = Mischief(port, lambda: (b"boot", 0))
    # Protected by a key that nobody has.
    header = bytes((0x58, 0x02, 0, 0)) + bytes(8) + bytes((0x99, 0x09, 0, 0xAA, 0xBB, 0xCC, 0xDD, 0xEE, 0xFF, 0))
    forged = [header[:-1] + b"\xff" + chance.randbytes(30) for _ in range(_KINDS // 4)]
    junk = forged + [mischief.datagram(forged) for _ in range(_KINDS)]
    outs = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(_SENDERS)]
    due_s = time.monotonic()
    while True:
        for _ in range(_PER_BURST):
            datagram = chance.choice(junk)
            # A message id of its own, so that each is a new one.
            chance.choice(outs).sendto(datagram[:2] + chance.randbytes(2) + datagram[4:], ("127.0.0.1", port))
        due_s += 1 / _BURSTS_PER_S
        time.sleep(max(0.0, due_s - time.monotonic()))


if __name__ == "__main__":
    flood(int(sys.argv[1]))
