"""Replays the stored runs, and says of each whether it comes out as it was."""

import sys

from kurt2rt.replay.comparing import compare
from kurt2rt.replay.reading import read_run
from kurt2rt.replay.replay import Replay
from tests.replay.stories import STORED, STORIES


def main() -> int:
    """0 where all do."""
    failed = 0
    for name in STORIES:
        found = next((each for tick in Replay(read_run(STORED / f"{name}.mcap")) for each in compare(*tick)), None)
        sys.stdout.write(f"{name}: {found or 'the same'}\n")
        failed += found is not None
    return failed


if __name__ == "__main__":
    sys.exit(main())
