"""Cases of the shipped table, and what one comes to with robots that are not as they should be."""

import anyio

from hal.robot_settings import RobotSettings, load_robot
from kurt2rt.checks.faults.suite import FaultTrial, try_case
from kurt2rt.checks.faults.table import FaultCase, FaultTable, Kind, Target, load_faults
from kurt2rt.core.task_settings import TaskSettings, load_task
from simbridge.faults.fault_rig import FaultRigFactory

TABLE: FaultTable = load_faults()
ROBOT: RobotSettings = load_robot(TABLE.robot)
TASK: TaskSettings = load_task(TABLE.task)


def case_of(target: Target, kind: Kind) -> FaultCase:
    return FaultCase(target, kind, TABLE.cases[target][kind])


def tried(target: Target, kind: Kind, *, seed: int = 1, robot: RobotSettings = ROBOT, **must: object) -> FaultTrial:
    """The case, on this robot; `must`: what the table says otherwise."""
    case = case_of(target, kind)
    case = case._replace(must=case.must.model_copy(update=must))
    return anyio.run(try_case, FaultRigFactory(robot), case, TABLE, robot, TASK, seed)


def with_guard(**limits: float) -> RobotSettings:
    """A robot whose guard has other limits than it should."""
    return ROBOT.model_copy(update={"guard": ROBOT.guard.model_copy(update=limits)})
