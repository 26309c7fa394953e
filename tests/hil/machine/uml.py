"""The uml way: a User-Mode Linux kernel as an ordinary process of this machine."""

import contextlib
import os
import platform
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from tests.hil.machine.order import Order
from tests.hil.machine.packages import SEARCH_PATH, need, program
from tests.hil.machine.processor import least_busy
from tests.hil.machine.task import INSIDE, INTERPRETER, TIME_LIMIT, write_task
from tests.hil.machine.trouble import MachineError
from tests.hil.machine.whole_xstate import whole_xstate

_INIT = Path(__file__).with_name("init.sh")
_DEBIAN_KERNEL = "linux.uml"
_SYSTEMD = "/lib/systemd/systemd"
_CONTROL_INSIDE = "/run/machine"
"""Path of the control directory inside the machine."""
_MEMORY_MIB = 1024
"""Memory of a machine; it takes what is touched."""
_SPARE_S = 30.0
"""Extra time in this machine's time: booting, and clocks that differ."""
_PATIENCE_S = 5.0
_LOOK_S = 0.05
_SHARED_MEMORY = Path("/dev/shm")
_LOG_LINES = 15
_TRACE = "[<"
"""Mark of kernel log lines that list a stack."""


class Uml:
    """A machine that is booted for one command."""

    def __init__(self, order: Order, *, install: bool = False) -> None:
        """See that what it takes is there. Raises MachineError that names the missing packages."""
        if platform.machine() != "x86_64":
            raise MachineError(f"User-Mode Linux runs on x86-64 only, not on {platform.machine()}")
        signs = {"ip": "iproute2", "setpriv": "util-linux", "taskset": "util-linux"}
        if order.kernel is None:
            signs |= {_DEBIAN_KERNEL: "user-mode-linux", "insmod": "kmod", "modprobe": "kmod"}
        if order.systemd:
            signs |= {_SYSTEMD: "systemd", "journalctl": "systemd"}
        need(signs, install=install)
        found = program(str(order.kernel or _DEBIAN_KERNEL))
        if found is None:
            raise MachineError(f"{order.kernel}: no such kernel, or it cannot be executed")
        self._kernel = found
        self._preloaded = whole_xstate(install=install)
        self._order = order

    def __str__(self) -> str:
        return f"uml: {self._kernel}"

    def run(self) -> int:
        """Boot, run the command, pass its output on; returns its exit status, or TIME_LIMIT.

        Raises MachineError when the machine ended without one; OSError.
        """
        if Path.cwd() == Path("/"):
            raise MachineError("not from /: start it in the project's directory, which the machine may write to")
        # Kernel arguments are separated by blanks.
        folder = None if " " not in tempfile.gettempdir() else "/tmp"
        with tempfile.TemporaryDirectory(prefix="kurt2rt-machine.", dir=folder) as name:
            control = Path(name)
            together = _same_file(1, 2)
            self._prepare(control, together=together)
            log = control / "log"
            with _Relay(control / "stdout", 1) as out, _Relay(control / "stderr", 2) as err:
                deadline_s = time.monotonic() + self._order.limit_s + _SPARE_S
                over = False
                with self._booted(control, log) as machine:
                    while machine.poll() is None and not over:
                        time.sleep(_LOOK_S)
                        out.pass_on()
                        err.pass_on()
                        over = time.monotonic() >= deadline_s
                out.pass_on()
                err.pass_on()
            return self._status(control, log, machine.returncode, over=over)

    def _prepare(self, control: Path, *, together: bool) -> None:
        (control / "uml").mkdir()
        for stream in ("stdout", "stderr"):
            (control / stream).touch()
        write_task(
            control / "task.json",
            self._order,
            stdout=f"{_CONTROL_INSIDE}/stdout",
            stderr=f"{_CONTROL_INSIDE}/{'stdout' if together else 'stderr'}",
            status=f"{_CONTROL_INSIDE}/status",
        )
        directories = [Path.cwd(), *(each.resolve() for each in self._order.shared)]
        (control / "shared").write_text("".join(f"{each}\n" for each in directories), encoding="utf-8")
        if self._order.systemd:
            (control / "systemd").symlink_to(_SYSTEMD)
        shutil.copy(INSIDE, control)
        inside = shlex.join([*INTERPRETER, f"{_CONTROL_INSIDE}/{INSIDE.name}", f"{_CONTROL_INSIDE}/task.json"])
        (control / "start").write_text(f"exec {inside} >>{_CONTROL_INSIDE}/complaints 2>&1\n", encoding="utf-8")
        shutil.copy(_INIT, control / "init")
        (control / "init").chmod(0o700)

    @contextlib.contextmanager
    def _booted(self, control: Path, log: Path) -> Iterator["subprocess.Popen[bytes]"]:
        """Run the machine as a process; end it with all its helper processes in every case."""
        words = [
            # Should this program be killed, the machine ends, too.
            *("setpriv", "--pdeathsig", "TERM", "taskset", "-c", str(least_busy())),
            *(self._kernel, f"mem={_MEMORY_MIB}M", "rootfstype=hostfs", "rootflags=/", "ro"),
            *("quiet", "panic=-1", "con=null", "con0=null,fd:1", f"uml_dir={control}/uml/", "umid=machine"),
            *(f"init={control}/init", "vcan.echo=1", *self._order.kernel_arguments),
        ]
        environment = {**os.environ, "PATH": SEARCH_PATH, "TMPDIR": str(self._memory_folder(control))}
        if self._preloaded is not None:
            environment["LD_PRELOAD"] = str(self._preloaded)
        resource.setrlimit(resource.RLIMIT_CORE, (0, resource.getrlimit(resource.RLIMIT_CORE)[1]))
        with log.open("wb") as console:
            machine = subprocess.Popen(
                words,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=console,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        try:
            yield machine
        finally:
            if machine.poll() is None:
                machine.terminate()
                with contextlib.suppress(subprocess.TimeoutExpired):
                    machine.wait(_PATIENCE_S)
            with contextlib.suppress(ProcessLookupError):
                os.killpg(machine.pid, signal.SIGKILL)
            machine.wait()

    def _memory_folder(self, control: Path) -> Path:
        """Return the folder of the file that is the machine's memory: it is sparse, and mapped executable.

        A container's /dev/shm may be too small or noexec for it; on a disk it is slower.
        """
        with contextlib.suppress(OSError):
            shared = os.statvfs(_SHARED_MEMORY)
            roomy = shared.f_bavail * shared.f_frsize > _MEMORY_MIB << 20
            if roomy and not shared.f_flag & os.ST_NOEXEC and os.access(_SHARED_MEMORY, os.W_OK):
                return _SHARED_MEMORY
        return control

    def _status(self, control: Path, log: Path, ended: int, *, over: bool) -> int:
        with contextlib.suppress(FileNotFoundError):
            return int((control / "status").read_text(encoding="ascii"))
        if over:
            print(f"machine: time limit of {self._order.limit_s} s; the machine was ended", file=sys.stderr, flush=True)
            return TIME_LIMIT
        lines = []
        for said in (control / "complaints", log):
            with contextlib.suppress(FileNotFoundError):
                text = said.read_text(encoding="utf-8", errors="replace")
                lines += [line for line in text.splitlines() if _TRACE not in line][-_LOG_LINES:]
        raise MachineError("\n    ".join([f"the uml machine ended early, exit status {ended}:", *lines]))


class _Relay:
    """Passes on what the machine writes to a file, as it comes."""

    def __init__(self, source: Path, descriptor: int) -> None:
        self._source = source
        self._descriptor = descriptor
        self._file: BinaryIO | None = None

    def __enter__(self) -> "_Relay":
        self._file = self._source.open("rb")
        return self

    def __exit__(self, *_: object) -> None:
        if self._file is not None:
            self._file.close()

    def pass_on(self) -> None:
        """Write what is new."""
        assert self._file is not None
        while part := self._file.read(1 << 16):
            while part:
                part = part[os.write(self._descriptor, part) :]


def _same_file(one: int, other: int) -> bool:
    """Return whether two descriptors lead to the same file; then the order of writes matters."""
    first, second = os.fstat(one), os.fstat(other)
    return (first.st_dev, first.st_ino) == (second.st_dev, second.st_ino)
