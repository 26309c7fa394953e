"""The library for processors with AMX: built where it is needed, and nowhere else."""

import ctypes
import shutil
from pathlib import Path

import pytest

from tests.hil.machine import whole_xstate as module
from tests.hil.machine.whole_xstate import whole_xstate

pytestmark = pytest.mark.skipif(shutil.which("gcc") is None, reason="no gcc to build with")


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "kurt2rt"


def processor(path: Path, flags: str, monkeypatch: pytest.MonkeyPatch) -> None:
    path.write_text(f"processor\t: 0\nflags\t\t: fpu {flags} avx512f\n", encoding="ascii")
    monkeypatch.setattr(module, "_PROCESSOR", path)


def test_a_processor_without_amx_needs_none(tmp_path: Path, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    processor(tmp_path / "cpuinfo", "sse2", monkeypatch)
    assert whole_xstate(install=False) is None
    assert not cache.exists()


def test_with_amx_it_is_built_once(tmp_path: Path, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    processor(tmp_path / "cpuinfo", "amx_tile", monkeypatch)
    library = whole_xstate(install=False)
    assert library is not None
    assert list(cache.iterdir()) == [library]
    assert ctypes.CDLL(str(library)).ptrace is not None  # AttributeError without it
    built_at = library.stat().st_mtime_ns
    assert whole_xstate(install=False) == library
    assert library.stat().st_mtime_ns == built_at
