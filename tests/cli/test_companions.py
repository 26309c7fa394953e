"""Child processes next to the robot program: one that dies is named and started again; all end with the program."""

import os
import queue
import select
import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from kurt2rt.service.child_processes import ChildProcesses

LONGEST_S = 60.0
LOOK_S = 0.01
SAYS_ITS_ID = """
import os, sys
with open("births", "w") as births:
    print(os.getpid(), file=births)
sys.stdin.read()
"""


class Births:
    """Named pipe into which each started child process writes its process id."""

    def __init__(self, path: Path) -> None:
        os.mkfifo(path)
        self._file = os.fdopen(os.open(path, os.O_RDWR))

    def next(self) -> int:
        ready, _, _ = select.select([self._file], [], [], LONGEST_S)
        assert ready, "no process was started"
        return int(self._file.readline())

    def close(self) -> None:
        self._file.close()


class Told(queue.SimpleQueue[str]):
    """Lines of the log of the child processes."""

    def next(self) -> str:
        return self.get(timeout=LONGEST_S)


@pytest.fixture
def births(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Births]:
    monkeypatch.chdir(tmp_path)
    opened = Births(tmp_path / "births")
    yield opened
    opened.close()


def companions(told: Told, script: str) -> ChildProcesses:
    return ChildProcesses(log=told.put, start=(sys.executable, "-c", script), poll_s=LOOK_S)


def is_there(process: int) -> bool:
    return Path(f"/proc/{process}").exists()


def test_killed_child_process_is_restarted_after_growing_pauses(births: Births) -> None:
    told = Told()
    with companions(told, SAYS_ITS_ID) as children:
        children.start("the page", "teach", restarts=True)
        for pause_s in ("0.01", "0.02", "0.04"):
            os.kill(births.next(), signal.SIGKILL)
            line = told.next()
            assert "(signal 9)" in line
            assert line.endswith(f" {pause_s} s")
        last = births.next()
        assert is_there(last)
    assert not is_there(last)
    assert told.empty()


def test_child_process_that_failed_stays_a_trouble() -> None:
    told = Told()
    with companions(told, "raise SystemExit(3)") as children:
        assert children.trouble == ""
        children.start("the scripted teacher", "teach", "--auto", restarts=False)
        line = told.next()
        assert line.startswith("the scripted teacher ")
        assert "code 3" in line
        assert children.trouble == line
    assert told.empty()


def test_child_process_output_goes_to_its_reader() -> None:
    told, heard = Told(), Told()
    says = "import sys; print('out', flush=True); print('err', file=sys.stderr, flush=True); sys.exit(3)"
    with companions(told, says) as children:
        children.start("the scripted teacher", "teach", "--auto", restarts=False)
        assert {told.next(), told.next()} == {"out", "err"}
        assert "code 3" in told.next()
        children.start("the page", "teach", restarts=False, on_line=heard.put)
        assert {heard.next(), heard.next()} == {"out", "err"}
        assert "code 3" in told.next()
    assert told.empty()


def test_child_process_imports_nothing_from_the_present_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "kurt2rt").mkdir()
    (tmp_path / "kurt2rt" / "__init__.py").write_text("raise SystemExit(7)", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    told = Told()
    with ChildProcesses(log=told.put, poll_s=LOOK_S) as children:
        children.start("pairing", "pair", restarts=True)  # which wants a name, and starts soonest
        assert "whose device?" in told.next()
        assert "code 2" in told.next()
