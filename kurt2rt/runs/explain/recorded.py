"""Explanation of a recorded decision: the run is replayed up to it."""

from collections.abc import Callable
from dataclasses import dataclass

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
    taught: set[str] = set()
    last_s = 0.0
    newest = difference = None
    for entry in run.entries():
        if newest is not None and run.elapsed_s(entry) > at_s:
            break
        last_s = run.elapsed_s(entry)
        taught.update(event.origin.command_id for event in entry.events)
        newest = replay.step(entry)
        if difference is None:
            difference = next(iter(compare(entry, newest)), None)
        if entry.tick % 100 == 0:
            report(last_s)
    if newest is None:
        raise empty_run_error(run)
    runtime = replay.runtime
    stamps.update(run.stamps(taught))
    facts = collect_facts(runtime, newest, lambda command_id: stamps.get(command_id, ""))
    found = sensor_counterfactuals(facts, runtime.definition, runtime.robot.infrared)
    return ExplainedMoment(facts, found, last_s, difference)
