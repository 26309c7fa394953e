"""Short soak runs with a fault nearly all the time."""

from contextlib import closing
from pathlib import Path

import anyio

from hal.kurt2_settings import Kurt2Settings, load_kurt2
from kurt2rt.checks.faults.table import FaultTable, load_faults
from kurt2rt.checks.soak.result import SoakResult
from kurt2rt.checks.soak.settings import MoodSettings, SoakSettings, load_soak
from kurt2rt.checks.soak.soak_run import SoakRun
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.runs.recording.budget import budget_of
from kurt2rt.runs.recording.recording import Recording
from kurt2rt.service.assembly import RunSettings
from kurt2rt.service.settings import ServiceSettings, load_service
from simbridge.faults.long_run_rig import LongRunRig

DAY: SoakSettings = load_soak()
TABLE: FaultTable = load_faults(DAY.faults)
ROBOT: Kurt2Settings = load_kurt2(TABLE.robot)
TASK: TaskSettings = load_task(DAY.task)
CYCLE_S = ROBOT.cycle_s

PATIENT = MoodSettings(
    share=1.0, lasts_s=(10.0, 20.0), phase=2, reaction_s=0.3, patience_s=0.3, error_rate=0.0, most_corrections=3
)


def busy_day(**changed: object) -> SoakSettings:
    """Return settings with a fault every few seconds and a restart every half a minute; `changed` replaces fields."""
    changes = {"lives_s": (25.0, 35.0), "fault_gap_s": 2.0, "first_corrections": 10, **changed}
    return DAY.model_copy(update=changes)


def service_in(folder: Path) -> ServiceSettings:
    return load_service().model_copy(
        update={"knowledge": str(folder / "soak.knowledge"), "checkpoint_period_s": DAY.checkpoint_period_s}
    )


def recording_in(folder: Path) -> Recording:
    return Recording(folder / "runs", budget_of(DAY.recordings_mb), "sim")


def soaked(folder: Path, minutes: float, soak: SoakSettings, seed: int = 1) -> SoakResult:
    """Run a soak of some minutes in `folder` and return its result."""
    with closing(LongRunRig(ROBOT, soak.world, seed)) as rig:
        day = SoakRun(rig, soak, TABLE, RunSettings(ROBOT, TASK, service_in(folder)), recording_in(folder), seed=seed)
        return anyio.run(day.run, minutes / 60.0, lambda _: None)
