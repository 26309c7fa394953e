"""A process that puts numbered frames on a shared bus as fast as it can until it is ended: NAME IDENTIFIER."""

import struct
import sys

from hal.frame import Frame
from hal.shared_bus import SharedBus

NUMBERED = struct.Struct(">II")


def payload(number: int) -> bytes:
    """Return the number and its complement, so that half a frame is detected."""
    return NUMBERED.pack(number, number ^ 0xFFFF_FFFF)


def main() -> None:
    """Write and never read."""
    bus = SharedBus(sys.argv[1])
    frame_id = int(sys.argv[2])
    number = 0
    while True:
        bus.send(Frame(frame_id, payload(number)))
        number += 1


if __name__ == "__main__":
    main()
