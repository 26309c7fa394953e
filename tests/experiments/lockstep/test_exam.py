import math
from collections.abc import Sequence

import anyio
import pytest

from hal.robot import STANDSTILL
from kurt2rt.core.rla.events import RlaCreated, TeachingEvent
from kurt2rt.core.rla.rla import Origin, Phase, Rla
from kurt2rt.core.task_settings import SuccessSettings, TaskSettings, load_task
from kurt2rt.core.teaching.commands import Teach
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.curriculum import run_exams
from kurt2rt.experiments.lockstep.drive_row import DriveRow, ExamVerdict
from kurt2rt.experiments.lockstep.runtimes import NoTeachingAllowed
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runtime import build_runtime
from simbridge.contracts.simulation import Position
from simbridge.worlds.world_loading import load_world
from tests.experiments.helpers import ROBOT, STAGE, Taught, short_task, teachers_drive
from tests.experiments.rows import row


def exam_of(events: Sequence[TeachingEvent], task: TaskSettings, seed: int = 1) -> DriveRow:
    async def run() -> tuple[DriveRow, ...]:
        return await run_exams(STAGE, ROBOT, task, events, task.exam.worlds, seed=seed, report=lambda *_: None)

    (result,) = anyio.run(run)
    return result


def knows_only(action: str) -> RlaCreated:
    """Return the creation of an RLA that is near every situation; its task needs a large radius."""
    return RlaCreated(Rla(1, (0.0,) * 72, action, 1e5, Origin("c-1", "Ann", Phase.SUPERVISED, 1)))


def test_exam_of_an_untaught_robot_ends_stuck() -> None:
    learned = exam_of([], short_task(exam_s=20.0, stuck_after_s=1.5))
    assert learned.stuck
    assert learned.duration_s == pytest.approx(1.51)
    assert learned.share_unknown == 1.0
    assert learned.asked_at == learned.trail[:1]
    assert len(set(learned.trail)) == 1
    assert (learned.progress, learned.unit, learned.way_m) == (0.0, "laps", 0.0)
    assert (learned.collisions, learned.action_changes_per_s) == (0, 0.0)


def test_exam_stuck_robot_fails_its_junction() -> None:
    task = load_task("streets")
    exam = task.exam.model_copy(update={"duration_s": 2.0, "stuck_after_s": 1.5})
    learned = exam_of([], task.model_copy(update={"exam": exam}))
    assert learned.stuck
    assert (learned.findings["junctions"], learned.findings["junctions right"]) == (1.0, 0.0)
    in_time = exam_of([], task.model_copy(update={"exam": exam.model_copy(update={"duration_s": 1.0})}))
    assert (in_time.stuck, in_time.findings["junctions"]) == (False, 0.0)


def test_the_teachers_own_drive_makes_way_and_touches_nothing() -> None:
    teacher = teachers_drive(short_task(exam_s=14.0, stuck_after_s=10.0))
    assert teacher.progress > 0.1
    assert 2.0 < teacher.way_m < 0.32 * 14.0  # on the spot at corners
    assert 0.0 < teacher.findings["distance error, m"] < 0.1
    assert teacher.collisions == 0
    assert not teacher.stuck
    assert teacher.duration_s == 14.0
    assert teacher.share_unknown == 0.0


def examined_from(start: str, seed: int = 1) -> DriveRow:
    """Return the exam of a robot near the post. It knows nothing, so it stays at its start."""
    task = load_task("circle")
    exam = task.exam.model_copy(update={"duration_s": 0.2, "start": start})
    return exam_of([], task.model_copy(update={"exam": exam}), seed)


@pytest.mark.parametrize(("start", "at_a_start_pose"), [("starts", True), ("in_sight", False)])
def test_an_exam_starts_where_the_task_says(start: str, *, at_a_start_pose: bool) -> None:
    world = load_world("one_object")
    (post,) = world.round_obstacles
    starts = [Position(pose.x_m, pose.y_m) for pose in world.start_poses]
    for seed in (1, 2):
        result = examined_from(start, seed)
        here = result.trail[0]
        assert result.teacher is not None
        assert any(math.dist(here, pose) < 0.001 for pose in starts) is at_a_start_pose
        assert math.dist(here, (post.x_m, post.y_m)) < post.radius_m + 0.45 + ROBOT.geometry.outline_length_m / 2 + 0.05
        assert result.way_m == pytest.approx(0.0, abs=0.001)
        # The teacher drives on from the same place.
        assert math.dist(here, result.teacher.trail[0]) < 0.1


def test_exam_start_in_sight_follows_the_seed() -> None:
    first, again, other = examined_from("in_sight"), examined_from("in_sight"), examined_from("in_sight", seed=2)
    assert first == again
    assert first.trail[0] != other.trail[0]


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
