"""The disk under a recording, when its calls fail: nothing stays open, nothing half made stays behind."""

import errno
import fcntl
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from kurt2rt.runs.recording.recording_disk import LockedFolder, RealDisk, is_locked


def open_files() -> int:
    return len(list(Path("/proc/self/fd").iterdir()))


def fails_with(number: int) -> Callable[..., None]:
    def fail(*_: object) -> None:
        raise OSError(number, os.strerror(number))

    return fail


def test_a_folder_is_held_until_it_is_let_go(tmp_path: Path) -> None:
    assert not is_locked(tmp_path)
    held = LockedFolder(tmp_path)
    assert is_locked(tmp_path)
    with pytest.raises(BlockingIOError):
        LockedFolder(tmp_path)
    held.close()
    assert not is_locked(tmp_path)


@pytest.mark.parametrize("number", [errno.ENOLCK, errno.EOPNOTSUPP])
def test_a_disk_without_locks_does_without(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int) -> None:
    monkeypatch.setattr(fcntl, "flock", fails_with(number))
    LockedFolder(tmp_path).close()
    assert not is_locked(tmp_path)


def test_failed_recovery_leaves_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    disk, before = RealDisk(), open_files()
    monkeypatch.setattr(fcntl, "flock", fails_with(errno.EIO))
    for look in (LockedFolder, is_locked):
        with pytest.raises(OSError, match="Input/output"):
            look(tmp_path)
    monkeypatch.setattr(os, "fsync", fails_with(errno.EIO))
    with pytest.raises(OSError, match="Input/output"):
        disk.make_folder(tmp_path / "run")
    assert not (tmp_path / "run").exists()
    with pytest.raises(OSError, match="Input/output"):
        disk.create(tmp_path / "0001.mcap")
    assert open_files() == before
