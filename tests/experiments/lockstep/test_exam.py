import anyio
import pytest

from hal.robot import STANDSTILL
from kurt2rt.core.rla.events import RlaCreated
from kurt2rt.core.rla.rla import Origin, Phase, Rla
from kurt2rt.core.task_settings import SuccessSettings
from kurt2rt.core.teaching.commands import Teach
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.drive_row import DriveRow, ExamVerdict
from kurt2rt.experiments.lockstep.runtimes import NoTeachingAllowed
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runtime import build_runtime
from tests.experiments.helpers import ROBOT, STAGE, Taught, short_task
from tests.experiments.rows import row


def knows_only(action: str) -> RlaCreated:
    """Return the creation of an RLA that is near every situation; its task needs a large radius."""
    return RlaCreated(Rla(1, (0.0,) * 72, action, 1e5, Origin("c-1", "Ann", Phase.SUPERVISED, 1)))


def test_exam_question_commands_standstill(taught: Taught) -> None:
    task = short_task(radius=150.0)
    simulation = STAGE.open("a", 1, "exam")
    records: list[TickRecord] = []
    try:
        clock = LockstepClock(simulation.step)
        runtime = build_runtime(simulation.robot, ROBOT, task, taught.events, NoTeachingAllowed(), clock)
        anyio.run(runtime.scheduler.run, 400, records.append)
    finally:
        simulation.close()
    asking = [record for record in records if record.decision.asking]
    assert 0 < len(asking) < len(records)
    assert all(record.decision.wheel_speeds == STANDSTILL for record in asking)
    assert all(record.guard_result.wheel_speeds == STANDSTILL for record in asking)
    assert all(record.decision.action is None for record in asking)


def test_a_lesson_in_an_exam_is_a_defect_and_no_silence() -> None:
    simulation = STAGE.open("a", 1, "exam")
    try:
        clock = LockstepClock(simulation.step)
        runtime = build_runtime(simulation.robot, ROBOT, short_task(), [], NoTeachingAllowed(), clock)
        runtime.inbox.put(Teach("t-1", "Ann", "forward"))
        with pytest.raises(RuntimeError, match="exam"):
            anyio.run(runtime.scheduler.run, 1, lambda _: None)
    finally:
        simulation.close()


PASSED, FAILED, NOT_JUDGED = ExamVerdict
DRIVE = row()
JUNCTIONS = row(findings={"junctions": 20.0, "junctions right": 18.0})


@pytest.mark.parametrize(
    ("drive", "teachers_laps", "success", "verdict"),
    [
        (DRIVE, 10.0, SuccessSettings(), PASSED),  # just enough
        (row(progress=7.999), 10.0, SuccessSettings(), FAILED),
        (row(progress=7.999), 10.0, SuccessSettings(progress_share=0.7), PASSED),
        (row(collisions=1), 10.0, SuccessSettings(), FAILED),
        (row(collisions=1), 10.0, SuccessSettings(collisions_at_most=1), PASSED),
        (row(stuck=True), 10.0, SuccessSettings(), FAILED),
        (row(alarm="bus lost"), 10.0, SuccessSettings(), FAILED),
        # Asking costs laps, which are judged.
        (row(share_unknown=0.5), 10.0, SuccessSettings(), PASSED),
        (row(progress=-1.0), 10.0, SuccessSettings(), FAILED),
        # A teacher that makes no way, or too little, is no measure.
        (row(progress=0.0), 0.0, SuccessSettings(), NOT_JUDGED),
        (DRIVE, -0.1, SuccessSettings(), NOT_JUDGED),
        (row(collisions=1), 0.0, SuccessSettings(), NOT_JUDGED),
        (row(least_progress=2.0), 2.0, SuccessSettings(), NOT_JUDGED),
        (row(least_progress=2.0), 2.001, SuccessSettings(), PASSED),
        (JUNCTIONS, 10.0, SuccessSettings(right_at_least=0.9), PASSED),
        (JUNCTIONS, 10.0, SuccessSettings(right_at_least=0.95), FAILED),
        (DRIVE, 10.0, SuccessSettings(right_at_least=0.9), FAILED),  # no junction, none right
    ],
)
def test_success_is_progress_without_a_collision(
    drive: DriveRow, teachers_laps: float, success: SuccessSettings, verdict: ExamVerdict
) -> None:
    assert drive.judged_by(teachers_laps, success).verdict is verdict
