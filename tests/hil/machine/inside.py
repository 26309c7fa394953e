"""The part that runs inside the machine: brings the interfaces up, runs the command, tells its exit status.

A program by itself, with nothing but the standard library: `python -I inside.py TASK.json`. The task holds `command`,
`environment`, `directory`, `interfaces`, `limit_s`; `prefix`, words before the command; `own_sys`, true when
/sys still shows the interfaces of another network namespace; `stdout`, `stderr`, files to append to, or null for this
program's own; `status`, the file for the exit status, or null for this program's own.
"""

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

TIME_LIMIT = 124
NO_MACHINE = 125
_NOT_EXECUTABLE, _NOT_FOUND = 126, 127
_PATIENCE_S = 5.0
_IFF_ECHO = 0x40000
_WATCHED = {signal.SIGCHLD, signal.SIGINT, signal.SIGTERM, signal.SIGHUP}


def bring_up(interfaces: list[str], *, own_sys: bool) -> None:
    """Make the interfaces. Raises subprocess.CalledProcessError, OSError; RuntimeError when vcan has no echo.

    With echo, frames come back to this machine's own listeners by the driver, after the queue discipline, as with an
    adapter. Without it they take a short cut: `tc` delays nothing, and a sender hears at once what the bus has yet to
    carry.
    """
    if own_sys:
        _do("mount", "-t", "sysfs", "sysfs", "/sys")
    _do("ip", "link", "set", "lo", "up")
    for name in interfaces:
        _do("ip", "link", "add", "dev", name, "type", "vcan")
        _do("ip", "link", "set", name, "up")
        if not int(Path(f"/sys/class/net/{name}/flags").read_text(encoding="ascii"), 16) & _IFF_ECHO:
            raise RuntimeError("the module vcan is loaded without echo=1: modprobe -r vcan && modprobe vcan echo=1")


def run(task: dict[str, Any]) -> int:
    """Run the command within its time limit. Returns its exit status, TIME_LIMIT, or what a shell would."""
    command = [*task["prefix"], *task["command"]]
    with ExitStack() as files:
        streams: dict[str, Any] = {
            name: files.enter_context(Path(task[name]).open("ab")) if task[name] else None
            for name in ("stdout", "stderr")
        }
        try:
            child = subprocess.Popen(
                command,
                env=task["environment"],
                cwd=task["directory"],
                stdin=subprocess.DEVNULL,
                start_new_session=True,
                **streams,
            )
        except OSError as error:
            _tell(streams, f"cannot run {command[0]}: {error.strerror}")
            return _NOT_FOUND if isinstance(error, FileNotFoundError) else _NOT_EXECUTABLE
        status, over = _wait(child, task["limit_s"])
        if over:
            _tell(streams, f"time limit of {task['limit_s']} s")
            return TIME_LIMIT
        return status if status >= 0 else 128 - status


def _wait(child: subprocess.Popen[bytes], limit_s: float) -> tuple[int, bool]:
    """Its return code, and whether it took too long. No polling: in simulated time each look would be an event."""
    signal.pthread_sigmask(signal.SIG_BLOCK, _WATCHED)
    deadline_s = time.monotonic() + limit_s
    over = False
    while child.poll() is None:
        came = signal.sigtimedwait(_WATCHED, max(0.0, deadline_s - time.monotonic()))
        if came is None:
            os.killpg(child.pid, signal.SIGKILL if over else signal.SIGTERM)
            deadline_s = time.monotonic() + _PATIENCE_S
            over = True
        elif came.si_signo != signal.SIGCHLD:
            os.killpg(child.pid, came.si_signo)
    with suppress(ProcessLookupError):  # what it left running
        os.killpg(child.pid, signal.SIGKILL)
    return child.returncode, over


def _tell(streams: dict[str, Any], text: str) -> None:
    (streams["stderr"] or sys.stderr.buffer).write(f"machine: {text}\n".encode())


def _do(*words: str) -> None:
    subprocess.run(words, check=True, stdin=subprocess.DEVNULL, capture_output=True, text=True)


def main() -> None:
    """Do the task."""
    task = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    try:
        bring_up(task["interfaces"], own_sys=task["own_sys"])
    except (OSError, RuntimeError, subprocess.CalledProcessError) as error:
        print(f"machine: {getattr(error, 'stderr', None) or error}".strip(), file=sys.stderr, flush=True)
        sys.exit(NO_MACHINE)
    status = run(task)
    if task["status"] is None:
        sys.exit(status)
    new = Path(f"{task['status']}.new")
    new.write_text(str(status), encoding="ascii")
    new.replace(task["status"])


if __name__ == "__main__":
    main()
