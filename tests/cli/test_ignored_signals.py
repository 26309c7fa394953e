"""Programs that were started with signals ignored, as nohup and shells start them, go on through these signals."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest

_NOHUP = (
    "import os, signal, sys; [signal.signal(each, signal.SIG_IGN) for each in (signal.SIGHUP, signal.SIGINT)]; "
    "os.execv(sys.executable, [sys.executable, *sys.argv[1:]])"
)


@pytest.mark.deep  # each starts an interpreter
@pytest.mark.parametrize(
    ("words", "started"),
    [
        (("run", "--port", "0", "--no-record"), "RLAs |"),
        (("sim", "--bus", "shared:ignored-signals"), "switches it off"),
        (("teach", "--for-run", "--port", "1", "--page-port", "0"), "http"),
    ],
    ids=["run", "sim", "teach"],
)
def test_ignored_signals_stay_ignored(tmp_path: Path, words: tuple[str, ...], started: str) -> None:
    command = (sys.executable, "-c", _NOHUP, "-m", "kurt2rt.cli.main", *words)
    with subprocess.Popen(
        command, cwd=tmp_path, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert any(started in line for line in process.stdout)
        for number in (signal.SIGHUP, signal.SIGINT):
            process.send_signal(number)
            # The kernel drops an ignored signal at once; one that is heeded would end the program.
            with pytest.raises(subprocess.TimeoutExpired):
                process.wait(0.5)
        process.terminate()
        process.stdout.read()
        assert process.wait(10) == 0
