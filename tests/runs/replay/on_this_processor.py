"""Replays so many seconds of the stored runs, and says of each whether they come out as they were."""

import sys

from kurt2rt.runs.replay.comparison import compare
from kurt2rt.runs.replay.replay import Replay
from tests.runs.replay.stored_runs import NAMES, stored


def main() -> int:
    """0 where all do."""
    seconds, failed = float(sys.argv[1]), 0
    for name in NAMES:
        found = next((each for tick in Replay(stored(name, seconds)) for each in compare(*tick)), None)
        sys.stdout.write(f"{name}: {found or 'the same'}\n")
        failed += found is not None
    return failed


if __name__ == "__main__":
    sys.exit(main())
