"""Execution of fault cases one after another."""

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
    """Case with one seed, its outcome and verdict."""

    case: FaultCase
    outcome: FaultOutcome
    verdict: FaultVerdict


async def try_case(
    rigs: RigFactory, case: FaultCase, table: FaultTable, settings: RobotSettings, task: TaskSettings, seed: int
) -> FaultTrial:
    """Run one case in a temporary folder and return its outcome with the verdict.

    The seed determines noise and the phases of fault, ticks and watchdog. Raises DidNotDriveError if the robot does not
    drive before the fault, KnowledgeError, SettingsError.
    """
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
    """Run each case with each seed and return all trials; `on_done` is called after each.

    Raises DidNotDriveError if a robot does not drive before its fault, KnowledgeError, SettingsError.
    """
    trials = []
    for case in cases:
        for seed in seeds:
            trial = await try_case(rigs, case, table, settings, task, seed)
            trials.append(trial)
            on_done(trial)
    return trials
