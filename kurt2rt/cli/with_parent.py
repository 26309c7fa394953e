"""The command line in a process that ends when its standard input does, so with the parent that holds the pipe."""

import os
import signal
import threading

from kurt2rt.cli.main import main


def _end_with_parent() -> None:
    """Read standard input until the parent process closes it, then end this process as SIGTERM does."""
    while os.read(0, 1024):
        continue
    os.kill(os.getpid(), signal.SIGTERM)


if __name__ == "__main__":
    threading.Thread(target=_end_with_parent, name="parent", daemon=True).start()
    main()
