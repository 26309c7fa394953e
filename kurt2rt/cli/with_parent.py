"""The command line in a process that ends when its standard input does, so with the parent that holds the pipe."""

import os
import signal
import threading

from kurt2rt.cli.main import main


def end_with_parent() -> None:
    """Start a thread that waits until the parent process closes standard input, then ends this process by SIGTERM."""

    def read() -> None:
        while os.read(0, 1024):
            continue
        os.kill(os.getpid(), signal.SIGTERM)

    threading.Thread(target=read, name="parent", daemon=True).start()


if __name__ == "__main__":
    end_with_parent()
    main()
