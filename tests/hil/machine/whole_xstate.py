"""Library that lets User-Mode Linux run on processors with AMX, built once where it is needed."""

import hashlib
import subprocess
import tempfile
from pathlib import Path

from tests.hil.machine.cache import cache_folder
from tests.hil.machine.packages import need
from tests.hil.machine.trouble import MachineError

_SOURCE = Path(__file__).with_name("whole_xstate.c")
_PROCESSOR = Path("/proc/cpuinfo")
_AMX = "amx_tile"


def whole_xstate(*, install: bool) -> Path | None:
    """Return the library to preload into the kernel's process; None for a processor without AMX.

    Raises MachineError that names missing packages or says why it cannot be built; OSError.
    """
    if _AMX not in _PROCESSOR.read_text(encoding="ascii", errors="replace").split():
        return None
    fingerprint = hashlib.sha256(_SOURCE.read_bytes()).hexdigest()[:12]
    library = cache_folder() / f"whole_xstate-{fingerprint}.so"
    if not library.exists():
        need({"gcc": "gcc", "/usr/include/stdlib.h": "libc6-dev"}, install=install)
        _build(library)
    return library


def _build(library: Path) -> None:
    """Build next to the library's place and move it there whole."""
    with tempfile.TemporaryDirectory(prefix="building.", dir=library.parent) as folder:
        built = Path(folder, library.name)
        words = ["gcc", "-O2", "-Wall", "-shared", "-fPIC", "-o", str(built), str(_SOURCE)]
        step = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
        if step.returncode != 0:
            raise MachineError(f"{_SOURCE} cannot be built: {' '.join(step.stderr.split())}")
        built.replace(library)
