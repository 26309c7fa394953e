"""Features of the critic are computed only where something reads them; the drives are the same."""

import anyio

from behaviors.metrics.task_metric import TaskMetric
from kurt2rt.core.rla.events import RlaCreated, TeachingEvent
from kurt2rt.core.rla.rla import Origin, Phase, Rla
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.exam import ExamSetup, examine
from tests.experiments.helpers import ROBOT, STAGE, short_task

DRIVES = RlaCreated(Rla(1, (0.0,) * 72, "forward", 1e5, Origin("c-1", "Ann", Phase.SUPERVISED, 1)))


def drive(events: list[TeachingEvent], *, appraises: bool) -> tuple[DriveRow, list[TickRecord]]:
    """Drive an exam of a second; return the result, and the records of its ticks."""
    task, records = short_task(exam_s=1.0), list[TickRecord]()

    def note(record: TickRecord, _metric: TaskMetric) -> None:
        records.append(record)

    simulation = STAGE.open("a", 1, "exam")
    try:
        setup = ExamSetup("a", 1, events=events, appraises=appraises, on_tick=note)
        return anyio.run(examine, simulation, ROBOT, task, setup, lambda _: None), records
    finally:
        simulation.close()


def test_an_exam_is_the_same_without_the_critics_features() -> None:
    (without, no_features), (with_them, features) = (drive([DRIVES], appraises=each) for each in (False, True))
    assert without == with_them
    assert all(record.appraisal_features is None for record in no_features)
    assert all(record.appraisal_features is not None for record in features)
    assert [each.decision for each in no_features] == [each.decision for each in features]
