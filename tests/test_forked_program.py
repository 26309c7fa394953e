"""A forked program behaves like a program with an interpreter of its own."""

import os
import signal
from pathlib import Path

from tests.cli.helpers import started
from tests.forked_program import ForkedProgram

LOOKS = """
import atexit, os, sys
atexit.register(lambda: print("the end is told"))
print(__name__, sys.argv[1:], os.getcwd(), os.environ["GREETING"], input())
print("a complaint", file=sys.stderr)
sys.exit(3)
"""


def test_forked_program_has_arguments_folder_variables_and_stdin(tmp_path: Path) -> None:
    (tmp_path / "looks.py").write_text(LOOKS, encoding="utf-8")
    with started("looks", "one", "two", folder=tmp_path, environment={"GREETING": "hello"}) as program:
        assert isinstance(program, ForkedProgram)
        assert program.poll() is None
        program.stdin.write("typed\n")
        said, complaints = program.communicate()
        assert program.wait() == program.returncode == 3
    assert said.splitlines() == [f"__main__ ['one', 'two'] {tmp_path} hello typed", "the end is told"]
    assert complaints == "a complaint\n"


def test_forked_program_knows_that_its_streams_are_pipes(tmp_path: Path) -> None:
    told = "import sys; print([each.seekable() for each in (sys.stdin, sys.stdout, sys.stderr)])"
    (tmp_path / "tells.py").write_text(told, encoding="utf-8")
    with started("tells", folder=tmp_path) as program:
        assert program.communicate() == ("[False, False, False]\n", "")


def test_it_can_be_killed_and_others_live_on(tmp_path: Path) -> None:
    (tmp_path / "waits.py").write_text("input()", encoding="utf-8")
    with started("waits", folder=tmp_path) as one, started("waits", folder=tmp_path) as other:
        assert one.pid != other.pid != os.getpid()
        one.kill()
        assert one.wait(60) == one.poll() == -signal.SIGKILL
        assert other.poll() is None
        other.terminate()
        assert other.wait(60) == -signal.SIGTERM
