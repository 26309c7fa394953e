"""Check that the robot carries out the commands of scripted teachers and examiners."""

from collections.abc import Callable, Iterable

from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.outcome_text import text_of
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.commands import CommandResult
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.lesson_keeping import LessonLostError


def require_carried_out(
    record: TickRecord, task: TaskSettings, may_be_late: Callable[[str], bool] = lambda _command_id: False
) -> int:
    """Return how many commands of a tick were refused because they came too late.

    Raises LessonLostError for any other refused command, with the command and the repertoire of the task.
    `may_be_late`: whether the command of an id may be refused.
    """
    if record.decision.cause is DecisionCause.BLIND:
        return 0  # the bus is in trouble, and nothing can be taught meanwhile; the teacher says it again
    return require_accepted(record.results, record.tick, task, may_be_late)


def require_accepted(
    results: Iterable[CommandResult], tick: int, task: TaskSettings, may_be_late: Callable[[str], bool]
) -> int:
    """Return how many commands of a tick were refused because they came too late (`require_carried_out`).

    Raises LessonLostError for any other refused command.
    """
    late = 0
    for result in results:
        if result.accepted:
            continue
        if may_be_late(result.command_id):
            late += 1
            continue
        raise LessonLostError(
            f"task {task.name}, tick {tick}: the robot refused {result.command_id}: {text_of(result.outcome)}",
            do=(
                f"make policy {task.policy.kind}, metric {task.metric.kind} and repertoire {task.repertoire} "
                "fit together"
            ),
        )
    return late
