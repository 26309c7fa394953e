"""Cases of the shipped table, and their trials with robots that have other limits."""

import anyio

from hal.kurt2_settings import Kurt2Settings, load_kurt2
from kurt2rt.checks.faults.suite import FaultTrial, try_case
from kurt2rt.checks.faults.table import FaultCase, FaultTable, Kind, Target, load_faults
from kurt2rt.core.task_settings import TaskSettings, load_task
from simbridge.faults.fault_rig import FaultRigFactory

TABLE: FaultTable = load_faults()
ROBOT: Kurt2Settings = load_kurt2(TABLE.robot)
TASK: TaskSettings = load_task(TABLE.task)


def case_of(target: Target, kind: Kind) -> FaultCase:
    return FaultCase(target, kind, TABLE.cases[target][kind])


def tried(target: Target, kind: Kind, *, seed: int = 1, robot: Kurt2Settings = ROBOT, **must: object) -> FaultTrial:
    """Try the case on this robot; `must` replaces fields of the table's row."""
    case = case_of(target, kind)
    case = case._replace(must=case.must.model_copy(update=must))
    return anyio.run(try_case, FaultRigFactory(robot), case, TABLE, robot, TASK, seed)


def with_guard(**limits: float) -> Kurt2Settings:
    """Return a robot whose guard has other limits than it should."""
    return ROBOT.model_copy(update={"guard": ROBOT.guard.model_copy(update=limits)})
