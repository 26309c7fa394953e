"""The robot stops for good in the middle of a lesson, or of an exam: by its guard, or for a broken sensor."""

from dataclasses import dataclass
from pathlib import Path

from hal.guard_reason import GuardReason
from kurt2rt.core.rla.rla import Phase
from kurt2rt.experiments.lockstep.drive_row import ExamVerdict
from kurt2rt.experiments.lockstep.faulty_sensor import FaultKind, FaultySensor
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan
from kurt2rt.experiments.study.exam_tables import exam_tables
from simbridge.robot_simulation import Kurt2Simulation
from simbridge.simulation import Kurt2SimulationFactory
from tests.experiments.helpers import ROBOT, examined, short_task, teach

TASK = short_task(exam_s=20.0)
ALARM_CYCLE = 500
SENSOR = 14
"""Place of the sensor that breaks."""


@dataclass(frozen=True)
class StageWithAnAlarm(Kurt2SimulationFactory):
    """The guard latches in the 500th cycle, as it does when the bus is lost."""

    def open(self, world: str, seed: int, purpose: str) -> Kurt2Simulation:
        simulation = super().open(world, seed, purpose)
        step, cycles = simulation.step, 0

        def step_on() -> None:
            nonlocal cycles
            cycles += 1
            if cycles == ALARM_CYCLE:
                simulation.robot.emergency_stop(GuardReason.BUS_LOST)
            step()

        simulation.step = step_on  # type: ignore[method-assign]
        return simulation


STAGE = StageWithAnAlarm(ROBOT)


def test_the_teacher_says_go_and_the_lesson_goes_on(tmp_path: Path) -> None:
    result = teach(tmp_path / "knowledge", TASK, stage=STAGE).result
    assert result.counts.alarms == sum(minute.go for minute in result.counts.workload) == 1
    at_the_alarm, a_second_later, end = (result.trail[at] for at in (26, 29, -1))
    assert at_the_alarm == a_second_later
    assert abs(end.x_m - a_second_later.x_m) + abs(end.y_m - a_second_later.y_m) > 0.2


def test_alarm_ended_by_a_demonstration_counts_once(tmp_path: Path) -> None:
    # Shown from 4.5 s on; the alarm comes at 5 s, and Resume before the second is over after which he says Go.
    plan = LessonPlan(((Phase.CRITIC, 8.0),), signs="judge", set_down_every_s=4.5, shown_s=1.0)
    result = teach(tmp_path / "knowledge", TASK, stage=STAGE, plan=plan).result
    assert [(minute.shown, minute.go) for minute in result.counts.workload] == [(1, 1)]
    assert result.counts.alarms == 1


@dataclass(frozen=True)
class StageWithABrokenSensor(Kurt2SimulationFactory):
    """A sensor repeats its reading from the first second on, and is noticed after 4 s of driving."""

    def open(self, world: str, seed: int, purpose: str) -> Kurt2Simulation:
        simulation = super().open(world, seed, purpose)
        frozen = FaultySensor(simulation.robot, ROBOT.infrared, SENSOR, FaultKind.FROZEN, 1.0)
        simulation.robot = frozen  # type: ignore[assignment]
        return simulation


def test_stop_for_a_broken_sensor_does_not_end_the_lesson(tmp_path: Path) -> None:
    result = teach(tmp_path / "knowledge", short_task(20.0, 0.0), stage=StageWithABrokenSensor(ROBOT)).result
    (minute,) = result.counts.workload
    assert (result.counts.alarms, result.counts.rescues) == (minute.go, minute.rescued) == (1, 1)
    carried, end = result.trail[-15], result.trail[-1]
    assert abs(end.x_m - carried.x_m) + abs(end.y_m - carried.y_m) > 0.1


def test_an_exam_ends_and_says_why() -> None:
    (result,) = examined(TASK, stage=STAGE)
    drive = result.teacher
    assert drive is not None
    assert drive.alarm == GuardReason.BUS_LOST
    assert drive.duration_s == ALARM_CYCLE / 100
    assert not drive.stuck
    # The teacher was stopped after a quarter of the time: that is no measure.
    assert result.verdict is ExamVerdict.NOT_JUDGED
    far = drive.model_copy(update={"least_progress": 0.0, "teacher": drive})
    assert far.judged_by(drive.progress, TASK.exam.success).verdict is ExamVerdict.FAILED
    assert any(drive.alarm in cell for cell in next(exam_tables([far], TASK)).rows[0])
