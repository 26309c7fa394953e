"""What a scripted teacher or an examiner says has to be carried out: nobody is there who would read a refusal."""

from kurt2rt.experiments.error import LessonLostError
from kurt2rt.layers.decision import Cause
from kurt2rt.tasks.settings import TaskSettings
from kurt2rt.tick import TickRecord


def require_carried_out(record: TickRecord, task: TaskSettings) -> None:
    """Raise LessonLostError for a command that this tick refused, with what it was and what the task is made of."""
    if record.decision.cause is Cause.BLIND:
        return  # the bus is in trouble, and nothing can be taught meanwhile; the teacher says it again
    for result in record.results:
        if not result.accepted:
            raise LessonLostError(
                f"task {task.name}, tick {record.tick}: the robot refused {result.command_id}: {result.text}; "
                f"make policy {task.policy.kind}, course {task.course.kind} and repertoire {task.repertoire} fit "
                "together"
            )
