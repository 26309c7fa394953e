"""A program that is told to end does first what comes first, and ends whatever hangs."""

import os
import signal
import subprocess
import sys
import threading

import pytest

from kurt2rt.service.shutdown import SHUTDOWN_SIGNALS, ShutdownClock, ShutdownHandler, ShutdownStage, timeout_message

HANGS = """
import ctypes, time
from kurt2rt.service.shutdown import ShutdownHandler, ShutdownStage, force_exit
with ShutdownHandler(on_timeout=force_exit) as ending:
    ending.stage = ShutdownStage.{stage}
    with ending.on_shutdown(lambda: print("wheels", flush=True), lambda: print("loop", flush=True), lambda: {act}):
        print("begun", flush=True)
        {body}
"""


def raise_here(number: signal.Signals) -> None:
    os.kill(os.getpid(), number)


@pytest.mark.parametrize("number", SHUTDOWN_SIGNALS)
def test_shutdown_runs_callbacks_once_and_in_order(number: signal.Signals) -> None:
    done: list[str] = []
    ended = threading.Event()
    before = signal.getsignal(number)
    with (
        ShutdownHandler() as ending,
        ending.on_shutdown(lambda: done.append("wheels"), lambda: done.append("loop"), ended.set),
    ):
        assert not ending.requested
        assert ending.remaining_s(100.0) == 100.0
        raise_here(number)
        assert ended.wait(60)
        raise_here(number)
        assert ending.requested
        assert ending.remaining_s(100.0) < 100.0
    assert done == ["wheels", "loop"]
    assert signal.getsignal(number) is before


def test_on_shutdown_after_the_signal_runs_at_once() -> None:
    done: list[str] = []
    heard = threading.Event()
    with ShutdownHandler() as ending:
        with ending.on_shutdown(heard.set):
            raise_here(signal.SIGTERM)
            assert heard.wait(60)
        with ending.on_shutdown(lambda: done.append("late")):
            assert done == ["late"]
    assert done == ["late"]


def test_one_that_fails_does_not_keep_the_next_from_being_done() -> None:
    stopped = threading.Event()

    def fail() -> None:
        raise ValueError("the brake is gone")

    def end() -> None:
        with ShutdownHandler() as ending, ending.on_shutdown(fail, stopped.set):
            raise_here(signal.SIGTERM)
            assert stopped.wait(60)

    with pytest.raises(ValueError, match="brake is gone"):
        end()


@pytest.mark.parametrize(
    ("stage", "body", "act", "exit_code"),
    [
        (ShutdownStage.LESSONS, "time.sleep(1000)", "None", 2),
        pytest.param(ShutdownStage.LESSONS, "while True: pass", "None", 2, marks=pytest.mark.deep),
        # Nothing was begun, so nothing is lost.
        pytest.param(ShutdownStage.START, "time.sleep(1000)", "None", 0, marks=pytest.mark.deep),
        # The interpreter as a whole, as soon as the signal was heard: the kernel ends it.
        (ShutdownStage.LESSONS, "time.sleep(1000)", "ctypes.PyDLL(None).sleep(1000)", -signal.SIGALRM),
    ],
    ids=["asleep", "busy", "start", "stuck"],
)
def test_shutdown_of_a_hanging_program_names_the_stage(
    stage: ShutdownStage, body: str, act: str, exit_code: int
) -> None:
    command = [sys.executable, "-c", HANGS.format(body=body, act=act, stage=stage.name)]
    says = "" if exit_code < 0 else timeout_message(stage)
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as program:
        assert program.stdout is not None
        assert program.stdout.readline() == "begun\n"
        program.send_signal(signal.SIGTERM)
        out, err = program.communicate()
    assert out == "wheels\nloop\n"
    assert err.startswith(says)
    assert program.returncode == exit_code


@pytest.mark.parametrize(
    ("real_s", "delayed_s", "left_s"),
    [
        (0.25, 0.0, 0.75),  # an idle machine
        (1.0, 0.0, 0.0),
        (3.9, 3.6, 0.7 * 4.0 / 0.4),  # a tenth of a processor: it had 0.3 s, and has 0.7 s
        (30.0, 300.0, 0.0),  # ten threads that waited together
        (0.25, -5.0, 0.75),  # threads that waited have ended
    ],
)
def test_left_s_counts_time_without_a_processor_as_none(real_s: float, delayed_s: float, left_s: float) -> None:
    now, delayed = [100.0], [0.0]
    clock = ShutdownClock(lambda: now[0], lambda: delayed[0], lambda: 5.0)
    assert clock.left_s(1.0, 5.0) == 5.0
    clock.start()
    now[0], delayed[0] = now[0] + real_s, delayed[0] + delayed_s
    assert clock.left_s(1.0) == pytest.approx(left_s)
    assert clock.left_s(1.0, 0.0) == 0.0


def test_left_s_at_the_signal_is_as_slow_as_the_program_was() -> None:
    clock = ShutdownClock(lambda: 100.0, lambda: 6.0, lambda: 2.0)
    clock.start()
    assert clock.left_s(1.0) == pytest.approx(4.0)
