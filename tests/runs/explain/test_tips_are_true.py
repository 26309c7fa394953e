"""Each counterfactual is tried in the replayed robot: the reading is changed, and the tick runs again."""

from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass

import pytest

from behaviors.judges.judge import AppraisalFeatures
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.runs.explain.collect import collect_facts
from kurt2rt.runs.explain.counterfactual import SensorCounterfactual, sensor_counterfactuals
from kurt2rt.runs.explain.facts import DecisionFacts
from kurt2rt.runs.recording.entries import TickEntry
from kurt2rt.runs.replay.replay import Replay
from tests.runs.replay.stored_runs import NAMES, stored

EVERY_TICKS, EVERY_KEPT = 397, 60
KEPT_TICKS_AT_MOST = 20
"""Nothing keeps an action for its minimum time that was chosen longer ago."""
DECIDED = (DecisionCause.RLA, DecisionCause.HELD, DecisionCause.UNKNOWN)


@dataclass(frozen=True)
class Before:
    """A robot as it was before a tick."""

    replay: Replay
    seen: list[AppraisalFeatures]
    """Features that the critic keeps of earlier ticks; they never change, so a copy of the robot shares them."""

    def again(self) -> Replay:
        """Return a copy of the robot as it was before the tick."""
        return deepcopy(self.replay, {id(each): each for each in self.seen})


def looked_at(name: str, every_ticks: int, every_kept: int) -> Iterator[tuple[Before, TickEntry, DecisionFacts]]:
    """Yield the robot before some ticks of a stored run, also before ticks in a minimum action time."""
    run = stored(name)
    replay = Replay(run)
    action, chosen_at = None, 0
    seen: list[AppraisalFeatures] = []
    for entry in run.entries():
        decided = entry.decision.cause in DECIDED
        regular = decided and entry.number % every_ticks == 0
        if entry.decision.action != action:
            action, chosen_at = entry.decision.action, entry.number
        may_be_kept = decided and entry.number - chosen_at <= KEPT_TICKS_AT_MOST and entry.number % every_kept == 0
        before = Before(Before(replay, seen).again(), seen) if regular or may_be_kept else None
        record = replay.step(entry)
        if record.appraisal_features is not None:
            seen.append(record.appraisal_features)
        if before is None:
            continue
        if regular or replay.runtime.level.held_action:
            yield before, entry, collect_facts(replay.runtime, record, lambda _: "")


def decided_with(before: Before, entry: TickEntry, tip: SensorCounterfactual, counts: int) -> str | None:
    """Return the action of that tick if the sensor reads `counts`; None for a question."""
    names = before.replay.run.robot.infrared.names
    infrared_counts = tuple(
        counts if name == tip.sensor else reading
        for name, reading in zip(names, entry.readings.infrared_counts, strict=True)
    )
    changed = entry._replace(readings=entry.readings._replace(infrared_counts=infrared_counts))
    return before.again().step(changed).decision.action


@pytest.mark.parametrize(
    ("name", "whole"), [("errand", False), *(pytest.param(name, True, marks=pytest.mark.deep) for name in NAMES)]
)
def test_the_robot_does_as_each_tip_says_and_not_a_count_earlier(name: str, whole: bool) -> None:
    heard = {"rla": 0, "kept": 0}
    for before, entry, facts in looked_at(name, EVERY_TICKS, EVERY_KEPT):
        found = sensor_counterfactuals(facts, before.replay.runtime.definition, before.replay.run.robot.infrared)
        # The smallest change, and the largest.
        for tip in {found[0], found[-1]} if found else ():
            at = entry.tick, tip.sensor, tip.needed_counts
            assert decided_with(before, entry, tip, tip.needed_counts) == tip.action, at
            step = 1 if tip.needed_counts > tip.counts else -1
            assert decided_with(before, entry, tip, tip.needed_counts - step) == facts.action, at
            kind = "kept" if facts.kept else facts.cause
            heard[kind] = heard.get(kind, 0) + 1
        if not whole and heard["rla"] > 5 and heard["kept"] > 2:
            break
    assert heard["rla"] > 5
    assert heard["kept"] > 2


def test_in_a_tick_with_a_lesson_nothing_is_said() -> None:
    """It was blamed in this one: what drove was withdrawn, and is no longer what would answer."""
    replay = Replay(stored("walls"))
    entry, record = next(tick for tick in replay if tick.entry.tick == 3201)
    facts = collect_facts(replay.runtime, record, lambda _: "")
    assert [type(event).__name__ for event in entry.events] == ["RlaRewarded", "ActionWithdrawn"]
    assert facts.taught_now
    assert sensor_counterfactuals(facts, replay.runtime.definition, replay.run.robot.infrared) == ()
