"""The disk under a recording, which keeps a trace of what is done to it."""

from pathlib import Path

from kurt2rt.runs.recording.recording_disk import RealDisk, WritableFile
from tests.crash.operations import FolderSynced, Made, Operation, Synced, SyncFailed, Written


class TracedDisk:
    """A real one (kurt2rt.runs.recording.recording_disk.Disk); some of its syncs fail."""

    def __init__(self, failing_syncs: tuple[int, ...] = ()) -> None:
        """`failing_syncs`: which ones, from 1."""
        self.operations: list[Operation] = []
        self._disk = RealDisk()
        self._failing_syncs = failing_syncs
        self._syncs = 0

    def make_folder(self, path: Path) -> None:
        self._disk.make_folder(path)

    def create(self, path: Path) -> WritableFile:
        file = self._disk.create(path)
        self.operations += [Made(path.name), FolderSynced()]
        return _TracedFile(path.name, file, self)

    def free_bytes(self, path: Path) -> int:
        return self._disk.free_bytes(path)

    def sync(self, name: str) -> None:
        self._syncs += 1
        if self._syncs in self._failing_syncs:
            self.operations.append(SyncFailed(name))
            raise OSError(f"{name}: the disk could not")
        self.operations.append(Synced(name))


class _TracedFile:
    def __init__(self, name: str, file: WritableFile, disk: TracedDisk) -> None:
        self._name = name
        self._file = file
        self._disk = disk

    def write_at(self, offset: int, data: bytes | bytearray) -> None:
        self._file.write_at(offset, data)
        self._disk.operations.append(Written(self._name, offset, bytes(data)))

    def sync(self) -> None:
        self._disk.sync(self._name)

    def close(self) -> None:
        self._file.close()
