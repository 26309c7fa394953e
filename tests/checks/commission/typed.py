"""`kurt2rt commission` with a simulated robot in real time, and answers that are typed."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from hal.codec import SIMULATED_HARDWARE_ID
from hal.kurt2_settings import SpeedMode, load_kurt2
from kurt2rt.checks.commission.checklist import STEPS, step_named
from kurt2rt.checks.commission.progress import Findings, Progress, StepOutcome, StepRecord, load_progress
from kurt2rt.cli.main import main
from simbridge.realtime import RealtimeSimulation
from tests.checks.commission.workshop import TODAY, Workshop
from tests.cli.helpers import Said

PROGRESS = Path("var", "commission", "robbie.json")


class Typed:
    """A keyboard at which one answer after the other is typed, each when it is asked for."""

    def __init__(self, *lines: str) -> None:
        self._lines = list(lines)

    def readline(self) -> str:
        return self._lines.pop(0) + "\n" if self._lines else ""


Type = Callable[..., Said]


def typing(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], folder: Path) -> Type:
    """Return a function that runs the command in a folder with typed answers."""
    monkeypatch.chdir(folder)

    def run(keyboard: Typed, *words: str) -> Said:
        monkeypatch.setattr(sys, "argv", ["kurt2rt", "commission", *words])
        monkeypatch.setattr(sys, "stdin", keyboard)
        exit_code: int | str | None = 0
        try:
            main()
        except SystemExit as end:
            exit_code = end.code
        out, err = capfd.readouterr()
        assert isinstance(exit_code, int | None)
        return Said(exit_code or 0, out, err)

    return run


@contextmanager
def live(workshop: Workshop) -> Iterator[None]:
    """Run the workshop's robot in real time, on its block."""
    workshop.robot.lifted = True
    with RealtimeSimulation(workshop.robot):
        yield


def earlier(folder: Path, *but: str) -> None:
    """Save the progress of an earlier session that passed all steps but some."""
    steps = {
        step.name: StepRecord(outcome=StepOutcome.PASSED, at=TODAY, who="anna")
        for step in STEPS
        if step.name not in but
    }
    found = Findings(hardware_id=SIMULATED_HARDWARE_ID, speed_mode=SpeedMode.SPEED)
    Progress(name="robbie", base="kurt2", bus="can0", findings=found, steps=steps).save(folder / PROGRESS)


def commission_the_rest(type_at: Type, spec: str, folder: Path, *steps: str) -> None:
    """Commission the missing steps, `stop` the last of them, and check the settings file."""
    earlier(folder, *steps)
    begin = [""] if "identity" in steps else []
    again = ["r", "", "", ""]  # after a stall of a busy machine, for which the guard stops the wheels
    said = type_at(Typed(*begin, "wheels up", "", "", "", *again * 5), spec, "--name", "robbie")
    assert said.err == ""
    assert said.exit_code == 0, said.out
    for line in (
        f"{len(steps) + 1} of {len(steps) + 1}: {step_named('stop').title}  [stop]",
        f"  passed: {step_named('stop').title}",
        "robbie: PASSED",
        "written: var/robots/robbie.yaml",
    ):
        assert line in said.out.splitlines()
    assert "--only modes" in said.out  # passed before
    assert "stopped" not in said.out
    robot = load_kurt2(str(folder / "var" / "robots" / "robbie.yaml"))
    assert robot.can.speed_mode is SpeedMode.SPEED
    assert 0.1 <= robot.motors.controller_watchdog_s <= 1.0
    report = (folder / PROGRESS).with_suffix(".txt").read_text(encoding="utf-8")
    assert report.splitlines()[0].endswith("PASSED")
    kept = load_progress(folder / PROGRESS)
    assert all(line in report for line in kept.steps["stop"].measured)
    assert kept.steps["stop"].who != "anna"
