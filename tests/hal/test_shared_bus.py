"""Bus across processes: conformance, failures of other processes, and access rights."""

import fcntl
import itertools
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import can
import pytest

from hal.bus import BusError, CanBus, open_bus
from hal.frame import Frame
from hal.shared_bus import KEPT_FRAMES, SHARED_MEMORY, SharedBus
from tests.forked_program import ForkedProcess, has_fork_server
from tests.hal.bus_conformance import Behind, Ends, ErrorFrameConformance, Join, joining
from tests.hal.helpers import cycle, send
from tests.hal.shared_bus_writer import NUMBERED, payload
from tests.patience import PATIENCE_S

ROOT = Path(__file__).parents[2]
WRITER = "tests.hal.shared_bus_writer"
RECORD_BYTES = 32

_numbers = itertools.count()


def new_name() -> str:
    return f"test-{os.getpid()}-{next(_numbers)}"


def file_of(name: str) -> Path:
    return SHARED_MEMORY / f"kurt2rt-can-{os.geteuid()}" / name


@contextmanager
def writing(name: str, frame_id: int, *, child: bool = False) -> Iterator["subprocess.Popen[bytes] | ForkedProcess"]:
    """Return a process that writes as fast as it can; `child`: a child process, which can be waited for."""
    writer: subprocess.Popen[bytes] | ForkedProcess
    if has_fork_server() and not child:
        writer = ForkedProcess(WRITER, (name, str(frame_id)), ROOT, os.environ, (0, 1, 2))
    else:
        writer = subprocess.Popen([sys.executable, "-m", WRITER, name, str(frame_id)], cwd=ROOT)
    try:
        yield writer
    finally:
        writer.kill()  # also when it is stopped
        writer.wait()


def waiting(bus: SharedBus) -> Iterator[can.Message]:
    while frame := bus.recv(0):
        yield frame


class Listener:
    """Takes numbered frames of writers, and sees to it that each is whole and comes after the one before."""

    def __init__(self, bus: SharedBus) -> None:
        self._bus = bus
        self._newest: dict[int, int] = {}

    def take(self) -> int:
        """Wait for the next frame and return its sender."""
        frame = self._bus.recv(PATIENCE_S)
        assert frame is not None
        number, turned = NUMBERED.unpack(frame.data)
        assert turned == number ^ 0xFFFF_FFFF
        assert number > self._newest.get(frame.arbitration_id, -1)
        self._newest[frame.arbitration_id] = number
        return frame.arbitration_id

    def take_until_from(self, sender: int) -> None:
        while self.take() != sender:
            pass

    def take_waiting(self) -> None:
        """All that is on the bus already."""
        here = os.fstat(_opened(self._bus)).st_size
        while self._bus._position < here and self._bus.recv(0) is not None:
            pass


def _opened(bus: SharedBus) -> int:
    assert bus._file is not None
    return bus._file


@pytest.fixture
def name() -> str:
    return new_name()


@pytest.fixture
def ends(name: str) -> Iterator[Ends]:
    with joining(lambda: open_bus(f"shared:{name}")) as join:
        yield join(), join()
    assert not file_of(name).exists()


class TestSharedBus(ErrorFrameConformance):
    behind = Behind.OLDEST_ARE_LOST
    too_many_frames = 2 * KEPT_FRAMES

    @pytest.fixture
    def join(self) -> Iterator[Join]:
        spec = f"shared:{new_name()}"
        with joining(lambda: open_bus(spec)) as join:
            yield join

    @pytest.fixture
    def ends(self, join: Join) -> Ends:
        return join(), join()


def test_a_killed_writer_leaves_no_trace_and_the_others_go_on(name: str) -> None:
    bus = SharedBus(name)
    listener = Listener(bus)
    with writing(name, 0x10) as victim, writing(name, 0x11):
        for sender in (0x10, 0x11, 0x10, 0x11):  # both are at it
            listener.take_until_from(sender)
        victim.kill()
        victim.wait()
        listener.take_waiting()
        for _ in range(2000):
            assert listener.take() == 0x11
        bus.send(Frame(0x12, payload(0)))
    assert bus.damaged == 0
    bus.shutdown()
    assert not file_of(name).exists()  # the lock of a killed process is gone as well


@pytest.mark.deep
def test_writers_may_be_killed_again_and_again(name: str) -> None:
    bus = SharedBus(name)
    with writing(name, 0x11):
        for round_ in range(15):
            listener = Listener(bus)
            with writing(name, 0x10) as victim:
                listener.take_until_from(0x10)
                for _ in range(37 * round_ % 101):  # somewhere else in its work each time
                    listener.take()
                victim.kill()
                victim.wait()
            listener.take_waiting()
            assert [listener.take() for _ in range(100)] == [0x11] * 100
    assert bus.damaged == 0
    bus.shutdown()


def test_a_stopped_writer_stops_nobody_else(name: str) -> None:
    bus, other = SharedBus(name), SharedBus(name)
    listener = Listener(bus)
    with writing(name, 0x10, child=True) as sleeper:
        for round_ in range(10):  # somewhere else in its work each time
            listener.take_until_from(0x10)
            sleeper.send_signal(signal.SIGSTOP)
            os.waitid(os.P_PID, sleeper.pid, os.WSTOPPED)
            listener.take_waiting()
            for number in range(100 * round_, 100 * round_ + 100):
                other.send(Frame(0x12, payload(number)))
                assert listener.take() == 0x12
            sleeper.send_signal(signal.SIGCONT)
    assert bus.damaged == 0
    other.shutdown()
    bus.shutdown()


def test_two_processes_are_heard_in_one_order_by_all(name: str) -> None:
    ahead, one, other = SharedBus(name), SharedBus(name), SharedBus(name)
    with writing(name, 0x10), writing(name, 0x11):
        listener = Listener(ahead)
        for sender in (0x10, 0x11, 0x10, 0x11):
            listener.take_until_from(sender)
    heard = [[(frame.arbitration_id, bytes(frame.data)) for frame in waiting(bus)] for bus in (one, other)]
    length = min(map(len, heard))
    assert heard[0][-length:] == heard[1][-length:]
    # Of what is kept all may be from one writer, when the other one had to wait for a processor.
    assert one.overruns or {sender for sender, _ in heard[0]} == {0x10, 0x11}
    ahead.shutdown()
    one.shutdown()
    other.shutdown()


def test_old_frames_do_not_pile_up(name: str, ends: Ends) -> None:
    send(ends[0], (Frame(0x10, payload(number)) for number in range(5 * KEPT_FRAMES)))
    status = file_of(name).stat()
    assert status.st_size > 5 * KEPT_FRAMES * RECORD_BYTES
    assert status.st_blocks * 512 < 1.5 * KEPT_FRAMES * RECORD_BYTES


def test_a_flood_of_what_is_not_heard_does_not_hold_up_a_look(ends: Ends) -> None:
    robot_end, far_end = ends
    robot_end.set_id_filter({0x11})
    send(far_end, (Frame(0x10, payload(number)) for number in range(5000)))
    send(far_end, [Frame(0x11, b"")])
    assert robot_end.drain() == []
    assert [frame.arbitration_id for frame in robot_end.drain()] == [0x11]


def test_foreign_records_are_skipped_and_counted(name: str) -> None:
    bus, other = SharedBus(name), SharedBus(name)
    other.send(Frame(0x10, payload(0)))
    with file_of(name).open("ab") as file:
        file.write(b"x" * 2 * RECORD_BYTES)
    other.send(Frame(0x10, payload(1)))
    heard = [bus.recv(0) for _ in range(5)]  # it looks twice at what may be on its way
    assert [bytes(frame.data) for frame in heard if frame] == [payload(0), payload(1)]
    assert (bus.damaged, bus.overruns) == (2, 0)
    bus.shutdown()
    other.shutdown()


def test_the_bus_is_gone_with_its_last_end_and_stays_until_then(name: str) -> None:
    one, other = SharedBus(name), SharedBus(name)
    one.shutdown()
    assert file_of(name).exists()
    third = SharedBus(name)
    third.send(Frame(0x10, b""))
    assert other.recv(0) is not None
    third.shutdown()
    other.shutdown()
    assert not file_of(name).exists()


def test_shutdown_removes_files_of_killed_processes(name: str) -> None:
    with writing(name, 0x10) as last:
        listener = SharedBus(name)
        assert listener.recv(PATIENCE_S) is not None
        listener.shutdown()
        last.kill()
        last.wait()
    assert file_of(name).exists()
    SharedBus(new_name()).shutdown()
    assert not file_of(name).exists()


def drain_often(bus: CanBus) -> None:
    for _ in range(200):
        assert bus.drain() == []


def test_end_with_removed_file_fails_until_reopened(name: str, ends: Ends) -> None:
    robot_end, _ = ends
    file_of(name).unlink()
    newcomer = SharedBus(name)
    with pytest.raises(BusError, match=f"{name} was removed"):
        drain_often(robot_end)
    with pytest.raises(BusError, match="removed"):
        robot_end.drain()
    robot_end.reopen()
    newcomer.send(cycle()[0])
    assert len(robot_end.drain()) == 1
    newcomer.shutdown()


def test_new_bus_waits_for_removal_of_the_old_file(name: str) -> None:
    path = file_of(name)
    SharedBus(name).shutdown()
    with path.open("wb") as leaving:  # not killed, but stopped while it removes the file
        path.chmod(0o600)
        fcntl.flock(leaving, fcntl.LOCK_EX)
        with pytest.raises(BusError, match=f"shared:{name}'.*removed"):
            open_bus(f"shared:{name}")
    path.unlink()


@pytest.mark.parametrize("bad", ["../x", ".x", "a/b", "a b", "x" * 65, "ä", "a\n"])
def test_a_name_is_a_plain_word(bad: str) -> None:
    with pytest.raises(BusError, match=" 64 ") as caught:
        open_bus(f"shared:{bad}")
    assert "\n" not in str(caught.value)


class TestNobodyElseGetsIn:
    @pytest.fixture(autouse=True)
    def folder(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
        monkeypatch.setattr("hal.shared_bus.SHARED_MEMORY", tmp_path)
        return tmp_path / f"kurt2rt-can-{os.geteuid()}"

    def test_folder_and_file_are_of_one_user(self, folder: Path) -> None:
        bus = SharedBus("x")
        assert [path.stat().st_mode & 0o777 for path in (folder, folder / "x")] == [0o700, 0o600]
        bus.shutdown()

    def test_an_open_folder_is_refused(self, folder: Path) -> None:
        folder.mkdir(mode=0o755)
        self.refused(" folder ")

    def test_a_readable_file_is_refused(self, folder: Path) -> None:
        folder.mkdir(mode=0o700)
        (folder / "x").touch(mode=0o644)
        self.refused(" file ")

    @pytest.mark.skipif(os.geteuid() != 0, reason="only root can give files away")
    @pytest.mark.parametrize("what", ["folder", "file"])
    def test_file_of_another_user_is_refused(self, folder: Path, what: str) -> None:
        folder.mkdir(mode=0o700)
        (folder / "x").touch(mode=0o600)
        os.chown(folder if what == "folder" else folder / "x", 12345, 12345)
        self.refused(f" {what} ")

    def test_links_are_refused(self, folder: Path, tmp_path: Path) -> None:
        elsewhere = tmp_path / "elsewhere"
        elsewhere.mkdir(mode=0o700)
        folder.symlink_to(elsewhere)
        self.refused("Not a directory")
        folder.unlink()
        folder.mkdir(mode=0o700)
        (folder / "x").symlink_to(elsewhere / "x")
        self.refused("symbolic links")

    def test_a_pipe_is_refused_at_once(self, folder: Path) -> None:
        folder.mkdir(mode=0o700)
        os.mkfifo(folder / "x", 0o600)
        self.refused(" file ")

    @pytest.mark.parametrize("content", [b"kurt2rt shared CAN bus, layout 2", b"x", bytes(64)])
    def test_a_file_of_another_version_is_refused_and_stays_as_it_is(self, folder: Path, content: bytes) -> None:
        folder.mkdir(mode=0o700)
        (folder / "x").touch(mode=0o600)
        (folder / "x").write_bytes(content)
        self.refused(" version;")
        assert (folder / "x").read_bytes() == content

    def test_a_machine_without_shared_memory_is_told(self, tmp_path: Path) -> None:
        tmp_path.rmdir()
        self.refused("No such file or directory")

    def refused(self, complaint: str) -> None:
        with pytest.raises(BusError, match=f"'shared:x'.*{complaint}"):
            open_bus("shared:x")
