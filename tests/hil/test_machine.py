"""The machine runs a command, tells how it ended, leaves nothing behind, and says what is missing."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.hil.machine.__main__ import main
from tests.hil.machine.packages import need
from tests.hil.machine.trouble import MachineError

ROOT = Path(__file__).parents[2]
MACHINE = (sys.executable, "-m", "tests.hil.machine")
boots = pytest.mark.boots


def in_uml(*words: str, **environment: str) -> "subprocess.CompletedProcess[str]":
    """Options and a command, in a machine that is booted, also where the native way would do."""
    return subprocess.run(
        [*MACHINE, "--way", "uml", *words],
        cwd=ROOT,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ([], "give a command"),
        (["--limit", "soon", "true"], "argument --limit: soon: give a whole number above 0"),
        (["--interface", "a/b", "true"], "argument --interface: a/b: no name for a network interface"),
        (["--share", "/nowhere", "true"], "argument --share: /nowhere: no such directory"),
        (["--way", "qemu", "true"], "argument --way: invalid choice: 'qemu'"),
    ],
)
def test_a_wrong_argument_is_told_in_a_line(
    arguments: list[str], complaint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    assert ended.value.code == 125
    assert capsys.readouterr().err.startswith(f"machine: {complaint}")


def test_need_missing_packages_prints_the_install_command() -> None:
    with pytest.raises(MachineError) as caught:
        need({"sh": "dash", "no-such-tool": "toolbox", "/usr/src/no-such-*.xz": "sources"}, install=False)
    missing, command = str(caught.value).splitlines()
    assert missing.endswith(": sources toolbox")
    assert " install --no-install-recommends sources toolbox " in command


@boots
def test_output_and_exit_status_come_through() -> None:
    done = in_uml("--", "sh", "-c", "echo out; echo err >&2; exit 7")
    assert (done.returncode, done.stdout, done.stderr) == (7, "out\n", "err\n")


@boots
def test_machine_keeps_files_of_shared_directories_only(tmp_path: Path) -> None:
    shared, other = tmp_path / "shared", tmp_path / "other"
    shared.mkdir()
    other.mkdir()
    done = in_uml(
        "--share", str(shared), "--", "sh", "-c", f"echo 1 >{shared}/kept; echo 1 >{other}/lost; cat {other}/*"
    )
    assert done.stdout == "1\n"
    assert (shared / "kept").read_text() == "1\n"
    assert list(other.iterdir()) == []


@boots
def test_machine_failed_boot_prints_its_last_lines() -> None:
    done = in_uml("--kernel-argument", "init=/nowhere", "true")
    assert done.returncode == 125
    assert done.stderr.startswith("machine: ")
    assert "Requested init /nowhere failed" in done.stderr


@boots
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_machine_and_leaves_nothing(tmp_path: Path, number: signal.Signals) -> None:
    words = [*MACHINE, "--way", "uml", "--", "sh", "-c", "echo up; sleep 1000"]
    environment = {**os.environ, "TMPDIR": str(tmp_path)}
    with subprocess.Popen(words, cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True) as runner:
        assert runner.stdout is not None
        assert runner.stdout.readline() == "up\n"
        runner.send_signal(number)
        assert runner.wait() == 128 + number
    assert list(tmp_path.iterdir()) == []
    assert not [line for line in command_lines() if str(tmp_path) in line]


@boots
def test_machine_simulated_time_skips_sleep_and_repeats_clock() -> None:
    # In real time this test's own limit would end it.
    words = ("--simulated-time", "--", "sh", "-c", "date +%s; sleep 600; date +%s.%N")
    first, second = in_uml(*words), in_uml(*words)
    began, ended = first.stdout.split()
    assert float(ended) - float(began) == pytest.approx(600.0, abs=1.0)
    assert first.stdout == second.stdout


def command_lines() -> list[str]:
    """Return the command lines of all processes here."""
    lines = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            lines.append(path.read_bytes().replace(b"\0", b" ").decode(errors="replace"))
        except ProcessLookupError:
            continue
        except FileNotFoundError:
            continue
    return lines
