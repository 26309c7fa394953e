"""The small kernel: User-Mode Linux with CAN built in and simulated time, built once from Debian's source package."""

import fcntl
import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.hil.machine.cache import cache_folder
from tests.hil.machine.packages import need
from tests.hil.machine.trouble import MachineError

_CONFIGURATION = Path(__file__).with_name("small_kernel.config")
_PATCH = Path(__file__).with_name("small_kernel.patch")
_SOURCES = Path("/usr/src")
_SOURCE_NAMES = "linux-source-*.tar.xz"
_SIGNS = {
    f"{_SOURCES}/{_SOURCE_NAMES}": "linux-source",
    "/usr/include/stdlib.h": "libc6-dev",
    "gcc": "gcc",
    "make": "make",
    "flex": "flex",
    "bison": "bison",
    "bc": "bc",
    "patch": "patch",
    "xz": "xz-utils",
}
_BUILD_BYTES = 2 << 30
_LOG_LINES = 20


def small_kernel(*, install: bool = False) -> Path:
    """Return the kernel of this configuration and patch: from the cache, or built in three minutes on two processors.

    Raises MachineError that names missing packages or says why it cannot be built; OSError.
    """
    cache = cache_folder()
    with (cache / "small_kernel.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # who comes second finds what the first has built
        kernel = _cached(cache)
        if kernel is None:
            need(_SIGNS, install=install)
            source = _newest_source()
            assert source is not None
            kernel = _place(cache, source)
            if not kernel.exists():
                _build(source, kernel)
        return kernel


def _cached(cache: Path) -> Path | None:
    """Return the cached kernel of the installed source, or the newest one if no source is installed."""
    source = _newest_source()
    if source is not None:
        kernel = _place(cache, source)
        return kernel if kernel.exists() else None
    return max(cache.glob(f"linux-*-{_fingerprint()}"), key=lambda path: path.stat().st_mtime, default=None)


def _newest_source() -> Path | None:
    return max(_SOURCES.glob(_SOURCE_NAMES), key=lambda path: path.stat().st_mtime, default=None)


def _place(cache: Path, source: Path) -> Path:
    """Return the path of the kernel of a source, this configuration and this patch."""
    package = source.name.removesuffix(".tar.xz")
    try:
        told = subprocess.run(
            ["dpkg-query", "--show", "--showformat=${Version}", package], capture_output=True, text=True, check=True
        )
    except (OSError, subprocess.CalledProcessError) as error:
        raise MachineError(f"{source} is not of a Debian package {package}, so its version is not known") from error
    return cache / f"linux-{told.stdout.strip()}-{_fingerprint()}"


def _fingerprint() -> str:
    return hashlib.sha256(_CONFIGURATION.read_bytes() + _PATCH.read_bytes()).hexdigest()[:12]


def _build(source: Path, kernel: Path) -> None:
    """Build in a temporary folder, then move the complete kernel to its place."""
    if shutil.disk_usage(kernel.parent).free < _BUILD_BYTES:
        raise MachineError(f"building the small kernel takes {_BUILD_BYTES >> 30} GiB under {kernel.parent} meanwhile")
    print(f"machine: building {kernel}, once, about 3 minutes on two processors", file=sys.stderr, flush=True)
    with tempfile.TemporaryDirectory(prefix="building.", dir=kernel.parent) as name:
        folder = Path(name)
        _do(["tar", "-C", name, "--strip-components=1", "-xf", str(source)], folder)
        _do(["patch", "--quiet", "-p1", "-i", str(_PATCH)], folder)
        make = ["make", "-s", "ARCH=um", f"-j{len(os.sched_getaffinity(0))}"]
        _do([*make, f"KCONFIG_ALLCONFIG={_CONFIGURATION}", "allnoconfig"], folder)
        got = set((folder / ".config").read_text(encoding="utf-8").splitlines())
        wanted = [
            line for line in _CONFIGURATION.read_text(encoding="utf-8").splitlines() if line.startswith("CONFIG_")
        ]
        refused = [line for line in wanted if line not in got]
        if refused:
            raise MachineError(f"{source} does not take {' '.join(refused)}")
        _do([*make, "linux"], folder)
        _do(["strip", "linux"], folder)
        (folder / "linux").replace(kernel)


def _do(words: list[str], folder: Path) -> None:
    step = subprocess.run(
        words, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False
    )
    if step.returncode != 0:
        said = step.stdout.decode(errors="replace").splitlines()[-_LOG_LINES:]
        raise MachineError("\n    ".join([f"{' '.join(words)} failed:", *said]))
