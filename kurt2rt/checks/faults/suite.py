"""Tries cases of the table, one after the other, and says of each whether it is as it must be."""

import tempfile
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

from hal.robot_settings import RobotSettings
from kurt2rt.checks.faults.fault_rig import RigFactory
from kurt2rt.checks.faults.judge import FaultVerdict, judge
from kurt2rt.checks.faults.outcome import FaultOutcome
from kurt2rt.checks.faults.scenario import run_scenario
from kurt2rt.checks.faults.table import FaultCase, FaultTable
from kurt2rt.core.task_settings import TaskSettings


class FaultTrial(NamedTuple):
    """A case, tried with one seed."""

    case: FaultCase
    outcome: FaultOutcome
    verdict: FaultVerdict


async def try_case(
    rigs: RigFactory, case: FaultCase, table: FaultTable, settings: RobotSettings, task: TaskSettings, seed: int
) -> FaultTrial:
    """Try one case. The seed makes noise, and the phases of fault, ticks and watchdog. Raises DidNotDriveError."""
    with tempfile.TemporaryDirectory(prefix="kurt2rt-faults-") as folder:
        outcome = await run_scenario(rigs, case, table, settings, task, seed=seed, folder=Path(folder))
    return FaultTrial(case, outcome, judge(case.must, outcome))


async def try_cases(
    rigs: RigFactory,
    cases: Iterable[FaultCase],
    table: FaultTable,
    settings: RobotSettings,
    task: TaskSettings,
    seeds: Sequence[int],
    on_done: Callable[[FaultTrial], None],
) -> list[FaultTrial]:
    """Try each case with each seed; `on_done` hears of every trial. Raises DidNotDriveError."""
    trials = []
    for case in cases:
        for seed in seeds:
            trial = await try_case(rigs, case, table, settings, task, seed)
            trials.append(trial)
            on_done(trial)
    return trials
