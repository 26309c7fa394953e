"""Explanation of a recorded decision: the run is replayed up to it."""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timedelta

from kurt2rt.core.rla.events import (
    ActionReplaced,
    ActionWithdrawn,
    LessonRedone,
    LessonUndone,
    RlaCreated,
    RlaDeleted,
    TeachingEvent,
)
from kurt2rt.core.rla.lesson_history import rla_id_of
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.runs.explain.collect import collect_facts
from kurt2rt.runs.explain.counterfactual import SensorCounterfactual, sensor_counterfactuals
from kurt2rt.runs.explain.facts import DecisionFacts
from kurt2rt.runs.replay.comparison import TickDifference, compare
from kurt2rt.runs.replay.replay import Replay, empty_run_error
from kurt2rt.runs.replay.run import Run


@dataclass(frozen=True, slots=True)
class ExplainedMoment:
    """Explanation of one decision of a recorded run: facts, sentences and changes that would have changed it."""

    facts: DecisionFacts
    counterfactuals: tuple[SensorCounterfactual, ...]
    """Changes of one reading that would have changed the decision."""
    at_s: float
    """Time from the first tick of the run."""
    difference: TickDifference | None
    """First difference between replay and recording; None without one."""


def explain_run(run: Run, at_s: float, report: Callable[[float], None] = lambda _s: None) -> ExplainedMoment:
    """Explain the last decision by `at_s` seconds from the first tick of the run.

    `report` is called every second of the run with the seconds replayed so far. Raises RecordingError if the run cannot
    be read or replayed.
    """
    replay = Replay(run)
    stamps = {lesson.event.origin.command_id: lesson.stamped_at for lesson in run.lessons}
    reckoned: dict[str, str] = {}
    counted = replay.runtime.statistics
    uses_before: dict[int, int] = {}
    last_s = 0.0
    newest = difference = None
    for entry in run.entries():
        if newest is not None and run.elapsed_s(entry) > at_s:
            break
        last_s = run.elapsed_s(entry)
        for event in entry.events:
            reckoned[event.origin.command_id] = _stamp(run.head.started_at, last_s)
            _count_uses_before(event, counted.uses, uses_before, replay.runtime.level.system)
        newest = replay.step(entry)
        if difference is None:
            difference = next(iter(compare(entry, newest)), None)
        if entry.tick % 100 == 0:
            report(last_s)
    if newest is None:
        raise empty_run_error(run)
    runtime = replay.runtime
    # As the journal has it; a recording that does not say so says to the second when the tick was.
    stamps.update({**reckoned, **run.stamps(reckoned.keys())})
    facts = collect_facts(runtime, newest, lambda command_id: stamps.get(command_id, ""), uses_before=uses_before)
    found = sensor_counterfactuals(facts, runtime.definition, runtime.robot.infrared)
    return ExplainedMoment(facts, found, last_s, difference)


def _count_uses_before(event: TeachingEvent, uses: dict[int, int], before: dict[int, int], system: RlaSystem) -> None:
    """Note how often an RLA had been used before it got its present action."""
    match event:
        case RlaCreated() | ActionReplaced() | ActionWithdrawn() | RlaDeleted():
            before[rla_id_of(event)] = uses.get(rla_id_of(event), 0)
        case LessonUndone(lesson) | LessonRedone(lesson):
            record = system.lesson(lesson)
            if record is not None and isinstance(
                record.event, RlaCreated | ActionReplaced | ActionWithdrawn | RlaDeleted
            ):
                before.pop(rla_id_of(record.event), None)  # the action is older than the run may know


def _stamp(started_at: str, at_s: float) -> str:
    """Return the estimated time of a tick to the second; the program started just before its first tick."""
    try:
        return (datetime.fromisoformat(started_at) + timedelta(seconds=at_s)).isoformat(timespec="seconds")
    except ValueError:
        return ""
