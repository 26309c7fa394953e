"""The power goes at any moment: what was said to be saved is there, once, and the file opens."""

from itertools import islice
from pathlib import Path

import pytest

from kurt2rt.knowledge.journal import journal_file
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from tests.crash.lessons_on_disk import a_day, require_kept, taught, teach
from tests.crash.operations import Operation
from tests.crash.power_cut import Disk, power_cuts
from tests.crash.restarts import a_lesson_at_a_time, with_patience
from tests.crash.watched_disk import Call, Failure, Fault, WatchedDisk, watched
from tests.knowledge.lessons import BINDING, entry

LEAST_STATES = 400
EVERY = [3, pytest.param(1, marks=pytest.mark.deep)]
"""Every third state in the quick test, all in the deep one."""


def files_of(folder: Path) -> dict[str, bytes]:
    """Return the contents of all files by name, without locks."""
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file() and path.suffix != ".lock"}


def new_file(folder: Path) -> Path:
    path = folder / "knowledge"
    Journal.open(path, BINDING).close()
    return path


def after_each_cut(disk: Disk, operations: list[Operation], path: Path, seed: int, every: int = 1) -> int:
    """Look at the file after every power cut there may be, or after each third; how many those are."""
    elsewhere = path.parent / "after"
    elsewhere.mkdir(exist_ok=True)
    states = 0
    for states, cut in enumerate(islice(power_cuts(disk, operations, seed), 0, None, every), start=1):
        cut.put(elsewhere)
        try:
            require_kept(elsewhere / path.name, cut.told)
        except (AssertionError, KnowledgeError) as error:
            sizes = {name: len(content) for name, content in cut.files.items()}
            error.add_note(f"state {states}, after operation {cut.after}, {cut.told} lessons told, files {sizes}")
            raise
    print(f"{states} states")
    return states


@pytest.mark.parametrize("every", EVERY)
def test_power_cut_keeps_every_acknowledged_lesson(tmp_path: Path, every: int) -> None:
    path, disk = new_file(tmp_path), WatchedDisk()
    before = Disk.holding(files_of(tmp_path))
    with watched(disk):
        a_day(path, disk)
    assert after_each_cut(before, disk.operations, path, seed=1, every=every) > LEAST_STATES // every


def test_next_program_syncs_writes_of_a_killed_one_first(tmp_path: Path) -> None:
    """The kernel shows the next program what the first never synced; the teacher's device sends its lesson again."""
    assert killed_after(tmp_path, range(9)) > LEAST_STATES // 4


@pytest.mark.deep
def test_it_is_so_wherever_it_is_killed(tmp_path: Path) -> None:
    assert killed_after(tmp_path, range(1000)) > 5 * LEAST_STATES


def killed_after(folder: Path, moments: range) -> int:
    """Kill the program after so many operations, start it again, cut the power; how many states were looked at."""
    path, first = new_file(folder), WatchedDisk()
    whole = files_of(folder)
    with watched(first):
        a_day(path, first)
    return sum(
        killed_then_cut(folder / "killed", path.name, whole, first.operations[:moment], seed=moment)
        for moment in moments
        if moment <= len(first.operations)
    )


def killed_then_cut(folder: Path, name: str, whole: dict[str, bytes], operations: list[Operation], seed: int) -> int:
    disk, second = Disk.holding(whole), WatchedDisk()
    for operation in operations:
        disk.do(operation)
    folder.mkdir(exist_ok=True)
    disk.now().put(folder)
    with watched(second), taught(folder / name) as journal:
        known = len(journal.events())
        if known:
            teach(journal, second, known)
    return after_each_cut(disk, second.operations, folder / name, seed)


def test_log_is_synced_while_a_reader_blocks_the_checkpoint(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = new_file(tmp_path)
    synced: list[Path] = []
    monkeypatch.setattr(journal_file, "fsync_file", synced.append)
    killed = Journal.open(path, BINDING)
    killed.append([entry(1), entry(2), entry(3)])
    with Journal.read_only(path) as reader:
        reading = reader._connection.execute("SELECT sequence FROM lesson")
        assert reading.fetchone() == (1,)
        killed.append([entry(4)])
        assert killed._lock is not None
        killed._lock.close()  # as the kernel does it for a program that is killed; its log stays
        with Journal.open(path, BINDING) as journal:
            assert len(journal.events()) == 4
        reading.close()
    assert synced == [journal_file.log_of(path)]
    killed.close()


@pytest.mark.parametrize(
    ("shard", "every"), [(0, 9), *(pytest.param(shard, 1, marks=pytest.mark.deep) for shard in (0, 1, 2))]
)
def test_data_of_a_failed_sync_is_rewritten_before_the_answer(tmp_path: Path, shard: int, every: int) -> None:
    """The kernel counts data as written after a failed sync: a second sync does not help."""
    path, sound = new_file(tmp_path), WatchedDisk()
    whole = files_of(tmp_path)
    with watched(sound):
        a_lesson_at_a_time(path, sound)
    syncs = [number for number, call in enumerate(sound.calls, start=1) if call is Call.SYNC]
    chosen = syncs[12:13] if shard == 0 else syncs[shard - 1 :: 2]
    states = 0
    for number in chosen:
        again = tmp_path / f"{number}"
        again.mkdir()
        (again / path.name).write_bytes(whole[path.name])
        disk = WatchedDisk(Fault(number, Failure.BROKEN))
        with watched(disk):
            with_patience(again / path.name, disk)
        assert disk.failed == [Call.SYNC]
        states += after_each_cut(Disk.holding(whole), disk.operations, again / path.name, number, every)
    assert states > LEAST_STATES // 2 // every
