"""Lessons of phases 3 to 5, and exams that go on where a robot is stuck, on the simulated robot."""

from dataclasses import replace
from pathlib import Path

import pytest

from config.settings import SettingsError
from kurt2rt.core.rla.events import Appraised, RlaCreated, RlaRewarded, TeachingEvent
from kurt2rt.core.rla.rla import CRITIC, Phase
from kurt2rt.core.rla.statistics import VALUES_INCLUDE, Statistics
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.exam import ExamSetup
from kurt2rt.experiments.lockstep.lesson import TrainingResult
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan, SignalTimes
from kurt2rt.knowledge.journal.journal import Journal
from tests.experiments.helpers import Taught, exam_on_bus, short_task, teach
from tests.experiments.lockstep.test_exam import knows_only


def go_on(
    taught: Taught, folder: Path, plan: LessonPlan, task: TaskSettings | None = None
) -> tuple[TrainingResult, list[TeachingEvent]]:
    """Another lesson behind the first one; the events that it brought."""
    knowledge = folder / "knowledge"
    knowledge.write_bytes(taught.knowledge.read_bytes())
    again = teach(knowledge, task or taught.task, plan=plan)
    assert again.events[: len(taught.events)] == taught.events
    return again.result, again.events[len(taught.events) :]


def of_phase(phase: Phase, lasts_s: float = 6.0, **more: object) -> LessonPlan:
    return LessonPlan(((phase, lasts_s),), purpose="another lesson", **more)  # type: ignore[arg-type]


def test_phase_3_stores_rewards_and_values(taught: Taught, tmp_path: Path) -> None:
    result, events = go_on(taught, tmp_path, of_phase(Phase.REINFORCEMENT, signs="judge"))
    rewards = [event for event in events if isinstance(event, RlaRewarded)]
    assert (
        len(rewards)
        == result.counts.positive_rewards + result.counts.negative_rewards - result.counts.refused_signals
        > 0
    )
    assert {event.origin.phase for event in rewards} == {Phase.REINFORCEMENT}
    assert (
        sum(minute.rewards for minute in result.counts.workload)
        == result.counts.positive_rewards + result.counts.negative_rewards
    )
    assert sum(minute.corrections for minute in result.counts.workload) == 0
    with Journal.read_only(tmp_path / "knowledge") as journal:
        assert journal.statistics().values == result.saved.values


def test_phase_4_teaches_the_critic_after_repositioning(taught: Taught, tmp_path: Path) -> None:
    times = SignalTimes(good_every_s=1.0)
    plan = of_phase(Phase.CRITIC, 12.0, signs="judge", times=times, set_down_every_s=4.0, shown_s=1.0)
    result, events = go_on(taught, tmp_path, plan)
    assert result.counts.repositions == 3
    assert [(minute.set_down, minute.shown) for minute in result.counts.workload] == [(3, 3)]
    critics = [event for event in events if isinstance(event, RlaCreated) and event.rla.level == CRITIC]
    assert critics
    assert all(isinstance(event, RlaCreated | Appraised) or event.origin.phase is Phase.CRITIC for event in events)
    assert sum(minute.appraisals for minute in result.counts.workload) >= len(critics)
    assert len(result.counts.agreement) == 1


def test_blame_by_chance_needs_no_judge_and_the_judge_s_does(taught: Taught, tmp_path: Path) -> None:
    blind = taught.task.model_copy(update={"judge": None})
    plan = of_phase(Phase.REINFORCEMENT, signs="chance", blame_by_chance=3)
    result, _ = go_on(taught, tmp_path, plan, blind)
    assert result.counts.negative_rewards == 3
    assert result.counts.positive_rewards == 0
    with pytest.raises(SettingsError):
        go_on(taught, tmp_path, of_phase(Phase.REINFORCEMENT, signs="judge"), blind)


def rival(action: str) -> RlaCreated:
    """Another RLA on the condition of `knows_only`."""
    first = knows_only("stand").rla
    return RlaCreated(replace(first, rla_id=2, action=action, origin=replace(first.origin, command_id="rival")))


@pytest.mark.parametrize(
    ("alone", "drives"),
    [
        (None, False),  # what its teacher had said of the newer one
        (Statistics(values={1: -0.3}), True),  # of the other one phase 5 had nothing to say yet
        (Statistics(values={2: 0.4}), False),
    ],
)
def test_exam_after_phase_5_uses_its_values(alone: Statistics | None, drives: bool) -> None:
    task = short_task(exam_s=2.0, radius=1e5)
    events = [knows_only("stand"), rival("forward")]
    # What a teacher had said of them does not count there.
    saved = Statistics(values={2: -0.05}, numbers={VALUES_INCLUDE: 2.0})
    setup = ExamSetup("a", 1, events=events, saved=saved, autonomous_values=alone)
    assert (exam_on_bus(task, setup).way_m > 0.3) is drives
