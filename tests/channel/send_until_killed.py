"""A device that takes sequence numbers without end: the child of test_oscore_context.py, which kills it.

Prints each number once it may be used.
"""

import os
import sys
from pathlib import Path

from kurt2rt.channel.security.oscore_context import OscoreContext


def send(folder: Path, chunk: int) -> None:
    context = OscoreContext(folder, chunk=chunk)
    while True:
        os.write(1, f"{context.new_sequence_number()}\n".encode())


if __name__ == "__main__":
    send(Path(sys.argv[1]), int(sys.argv[2]))
