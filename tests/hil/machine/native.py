"""The native way: this machine's own kernel makes the interfaces, in a network namespace of their own.

So no test takes down a vcan0 that is in use, and nothing is left to clean up.
"""

import os
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from tests.hil.machine.order import Order
from tests.hil.machine.packages import as_root, program
from tests.hil.machine.task import INSIDE, INTERPRETER, write_task
from tests.hil.machine.trouble import MachineError

_OWN_NAMESPACE = ("unshare", "--net", "--mount")


class Native:
    """This machine's own kernel."""

    def __init__(self, enter: Sequence[str], prefix: Sequence[str]) -> None:
        """`enter` are the words that enter a namespace, `prefix` those that leave root's rights behind in it."""
        self._enter = tuple(enter)
        self._prefix = tuple(prefix)

    def __str__(self) -> str:
        return f"native: vcan of this machine's kernel, by {' '.join(self._enter)}"

    def run(self, order: Order) -> int:
        """Run the order's command; returns its exit status, or one of inside.py's."""
        return self._finish(order).returncode

    def try_out(self, order: Order) -> str:
        """Run nothing in the order's machine; returns why it cannot be had, empty when it can."""
        trial = self._finish(replace(order, command=("true",)), quiet=True)
        if trial.returncode == 0:
            return ""
        return trial.stderr.strip().removeprefix("machine: ") or f"exit status {trial.returncode}"

    def _finish(self, order: Order, *, quiet: bool = False) -> "subprocess.CompletedProcess[str]":
        with tempfile.TemporaryDirectory(prefix="kurt2rt-machine.") as folder:
            task = Path(folder) / "task.json"
            write_task(task, order, prefix=self._prefix, own_sys=True)
            words = [*self._enter, *INTERPRETER, str(INSIDE), str(task)]
            # A signal to this program is one to the command, too; inside.py passes it on.
            with subprocess.Popen(words, stdin=subprocess.DEVNULL, stderr=_pipe(quiet), text=True) as process:
                try:
                    _, complaints = process.communicate()
                except BaseException:
                    process.terminate()
                    raise
        return subprocess.CompletedProcess(words, process.returncode, None, complaints or "")


def find_native(order: Order) -> Native:
    """Return the first way that works here for an order. Raises MachineError with the reasons if none does."""
    if program("ip") is None or program("unshare") is None:
        raise MachineError("no native machine: ip or unshare is missing; Debian packages: iproute2 util-linux")
    _load_vcan()
    complaints = []
    for native in _ways():
        why_not = native.try_out(order)
        if not why_not:
            return native
        complaints.append(why_not.splitlines()[-1])
    raise MachineError(f"no native machine: {'; '.join(dict.fromkeys(complaints))}")


def _ways() -> Iterator[Native]:
    if os.geteuid() == 0:
        yield Native(_OWN_NAMESPACE, ())
        return
    yield Native((*_OWN_NAMESPACE, "--map-root-user"), ())
    if program("sudo") is not None:
        # Where user namespaces are forbidden: root makes the machine, the command keeps of it the right to set links.
        own = (f"--reuid={os.geteuid()}", f"--regid={os.getegid()}", "--init-groups")
        yield Native(
            ("sudo", "-n", *_OWN_NAMESPACE),
            ("setpriv", *own, "--inh-caps=+net_admin", "--ambient-caps=+net_admin", "--"),
        )


def _load_vcan() -> None:
    """Load the module with echo, where that is possible at all; the trial shows whether it helped."""
    if program("modprobe") is None or (as_root() and program("sudo") is None):
        return
    words = [*as_root(), "modprobe", "vcan", "echo=1"]
    subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, check=False)


def _pipe(quiet: bool) -> int | None:
    return subprocess.PIPE if quiet else None
