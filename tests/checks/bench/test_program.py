"""Processor time of the program, against an empty loop."""

from pathlib import Path

import numpy as np
import pytest

from kurt2rt.checks.bench.program import ProcessorUse, ProgramDrive, ProgramTurns, drive_program, program_results
from kurt2rt.checks.bench.robot_under_test import BenchFixture
from kurt2rt.runs.recording.run_folder import runs_in


def use(user_us: float, system_us: float, ticks: int = 100) -> ProcessorUse:
    return ProcessorUse(user_us, system_us, 2 * ticks, ticks, ticks)


def test_the_program_is_judged_by_the_median_of_its_rounds() -> None:
    drive = ProgramDrive(
        (use(30_000.0, 10_000.0), use(35_000.0, 15_000.0), use(80_000.0, 20_000.0)),
        (use(4_000.0, 6_000.0),),
        np.array([80_000, 90_000, 300_000], dtype=np.int64),
        missed_ticks=1,
        driving=150,
    )
    program, tick = program_results(drive, 0.01)
    assert program.took.median_us == pytest.approx(500.0)
    assert program.reference is not None
    assert program.reference.ratio == pytest.approx(100.0 / 500.0)
    (goal,) = program.goals
    assert goal.measured == pytest.approx(5.0)
    assert goal.met
    for said in ("5.0 % of a core", "300 ticks, 1 missed, 50% driving", "483 us user", "150 us system", "2.0 times"):
        assert said in program.note
    assert [goal.met for goal in tick.goals] == [True, False]


def test_use_between_two_readings() -> None:
    assert use(5.0, 7.0, ticks=10).since(use(1.0, 2.0, ticks=4)) == ProcessorUse(4.0, 5.0, 12, 6, 6)


@pytest.mark.deep
async def test_the_service_drives_a_robot_of_another_process(subject: BenchFixture, tmp_path: Path) -> None:
    told: list[float] = []
    drive = await drive_program(subject, tmp_path, ProgramTurns(rounds=1, ticks=30, empty_ticks=10), told.append)
    assert told == [1.0]
    (program,), (empty,) = drive.program, drive.empty
    assert 0 < program.ticks <= 30
    assert program.tick_us > 0.0
    assert 0 < empty.ticks <= 10
    assert 0 < drive.driving <= program.ticks
    assert (drive.tick_ns > 0).all()
    assert len(runs_in(tmp_path / "runs")) == 1
