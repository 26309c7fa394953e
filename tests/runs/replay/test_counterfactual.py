"""Other knowledge looks on at a run, and it is told where it would have decided otherwise."""

import math
from collections import Counter
from pathlib import Path

import pytest

from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.rla.events import ActionReplaced, ActionWithdrawn, RlaCreated, TeachingEvent
from kurt2rt.core.rla.rla import BASIC, Origin, Phase, Rla
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.loading import open_knowledge
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.replay.counterfactual import counterfactual
from kurt2rt.runs.replay.counterfactual_policy import CounterfactualPolicy, load_policy, recorded_answers
from kurt2rt.runs.replay.replay import Replay
from kurt2rt.runs.replay.run import Run
from tests.runs.replay.stored_runs import NAMES, stored

ORIGIN = Origin("later", "Ann", Phase.CORRECTIONS, 5)


def of_every_story(first: str, seconds: float) -> pytest.MarkDecorator:
    """Parametrize with the beginning of one story; the deep suite adds every whole story."""
    whole = [pytest.param(name, 44.0, marks=pytest.mark.deep) for name in NAMES]
    return pytest.mark.parametrize(("name", "seconds"), [(first, seconds), *whole])


def taught_in(run: Run) -> list[TeachingEvent]:
    return [event for entry in run.entries() for event in entry.events]


@pytest.fixture(scope="module")
def lessons() -> dict[str, list[TeachingEvent]]:
    return {name: taught_in(stored(name)) for name in NAMES}


@of_every_story("walls", 16.0)
def test_counterfactual_of_no_knowledge_asks_at_each_drive(
    name: str, seconds: float, lessons: dict[str, list[TeachingEvent]]
) -> None:
    run = stored(name, seconds)
    whole = CounterfactualPolicy(run, lessons[name])
    found = counterfactual(run, CounterfactualPolicy(run, ()), whole)
    assert found.would_ask > 500
    assert (found.other_action, found.would_drive) == (0, 0)
    stretch = next(each for each in found.stretches if each.level == BASIC)
    assert stretch.would_be == (None, None, math.inf, 0.0)
    assert stretch.was.rla is not None
    assert stretch.was.distance <= stretch.was.radius
    assert sum(each.ticks for each in found.stretches if each.level == BASIC) == found.would_ask
    assert all(each.from_s <= each.to_s <= seconds for each in found.stretches)


def test_counterfactual_of_later_knowledge_asks_less(lessons: dict[str, list[TeachingEvent]]) -> None:
    run = stored("errand", 24)
    assert counterfactual(run, CounterfactualPolicy(run, lessons["errand"])).would_drive > 100


def test_counterfactual_stretches_name_the_corrected_rla(lessons: dict[str, list[TeachingEvent]]) -> None:
    run = stored("walls", 12)
    known = lessons["walls"]
    used = CounterfactualPolicy(run, known)
    counted: dict[int, int] = {}
    for each in counterfactual(run, CounterfactualPolicy(run, ()), used).stretches:
        assert each.was.rla is not None
        counted[each.was.rla.rla_id] = counted.get(each.was.rla.rla_id, 0) + each.ticks
    most = max(counted, key=lambda rla_id: counted[rla_id])
    other = "back" if used_action(used, most) != "back" else "forward"
    found = counterfactual(run, CounterfactualPolicy(run, [*known, ActionReplaced(most, other, "", ORIGIN)]), used)
    assert found.other_action == counted[most]
    assert {each.would_be.action for each in found.stretches} == {other}
    assert {each.would_be.rla.rla_id for each in found.stretches if each.would_be.rla is not None} == {most}


def used_action(shadow: CounterfactualPolicy, rla_id: int) -> str:
    rla = shadow._system.get(rla_id)
    assert rla is not None
    return rla.action


@of_every_story("walls", 36.0)
def test_recorded_answer_is_the_decision_despite_a_later_lesson(name: str, seconds: float) -> None:
    run = stored(name, seconds)
    replay = Replay(run)
    heard: Counter[str] = Counter()
    taught_now = 0
    for entry, record in replay:
        answer = recorded_answers(record, replay.runtime).basic
        decision = record.decision
        if decision.cause is DecisionCause.RLA:
            assert answer.rla is not None
            assert (answer.rla.rla_id, answer.action) == (decision.rla_id, decision.action), entry.tick
            taught_now += bool(entry.events)
        elif decision.cause is DecisionCause.UNKNOWN:
            assert answer.action is None, entry.tick
        heard[decision.cause.value] += 1
    assert heard["rla"] > 1000
    assert heard["unknown"] > 100
    assert taught_now > 2


def test_recorded_answer_keeps_an_action_withdrawn_in_its_tick() -> None:
    """A critic withdraws the action at the end of the tick that it drove."""
    run = stored("walls")
    replay = Replay(run)
    for _entry, record in replay:
        if record.decision.cause is DecisionCause.RLA and record.tick > 1200:
            break
    rla_id = record.decision.rla_id
    assert rla_id is not None
    replay.runtime.level.apply(ActionWithdrawn(rla_id, "", ORIGIN))
    assert recorded_answers(record, replay.runtime).basic.action == record.decision.action


def test_knowledge_comes_from_a_file_and_the_file_stays_as_it_is(
    tmp_path: Path, lessons: dict[str, list[TeachingEvent]]
) -> None:
    run = stored("walls", 10)
    path = tmp_path / "walls.knowledge"
    with open_knowledge(path, run.robot, run.task) as journal:
        journal.append([JournalEntry(event, "2026-11-22T03:00:00Z") for event in lessons["walls"]])
    before = path.read_bytes()
    assert counterfactual(run, load_policy(run, path), CounterfactualPolicy(run, lessons["walls"])).same
    assert path.read_bytes() == before


def test_knowledge_of_other_features_is_refused() -> None:
    run = stored("walls")
    with pytest.raises(RecordingError, match="knowledge"):
        CounterfactualPolicy(run, [RlaCreated(Rla(1, (1.0, 2.0), "forward", None, ORIGIN))])
