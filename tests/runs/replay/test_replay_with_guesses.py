"""Recorded run of a robot that passes over a guess: replayed bit for bit, and explained."""

from pathlib import Path

from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.rla.lesson_history import hold_of
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import load_task
from kurt2rt.core.teaching.commands import HoldAction, Resume, SetPhase, Stop, Teach, Watch
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.runs.explain.collect import collect_facts
from kurt2rt.runs.replay.comparison import compare
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.runs.replay.replay import Replay
from simbridge.contracts.simulation import Pose
from tests.runs.replay.stories import NAME, Scene, record_story

ANSWERED = tuple(range(20, 70, 10))
HELD = range(100, 160)
ALONE = 170


def slips_and_leaves(scene: Scene, record: TickRecord) -> None:
    """Answer forward at five headings next to a wall, hold a whirl between them, and go on in phase 5."""
    inbox, tick = scene.runtime.inbox, record.tick
    if tick == 1:
        inbox.put(Resume("go", NAME))
    inbox.put(Watch(NAME, tick))
    if tick + 5 in ANSWERED:
        scene.simulation.put(Pose(2.0, 0.4, 0.25 * ANSWERED.index(tick + 5)))
    if tick in ANSWERED:
        inbox.put(Teach(f"t{tick}", NAME, "forward"))
    if tick == HELD.start - 20:
        scene.simulation.put(Pose(2.0, 0.27, 0.6))
    if tick in HELD:
        inbox.put(HoldAction(NAME, tick, 7, "whirl_left"))
    if tick == HELD.stop:
        inbox.put(Stop("let go", NAME, 7))
    if tick == ALONE:
        scene.simulation.put(Pose(2.0, 0.27, 0.9))  # where the hold taught
        inbox.put(SetPhase("alone", NAME, Phase.AUTONOMOUS))


def test_run_over_a_guess_is_replayed_bit_for_bit(tmp_path: Path) -> None:
    task = load_task("wall_following")
    assert task.learning.skip_uncertain_lessons
    run = read_run(record_story("walls", tmp_path, seconds=2, other=slips_and_leaves, task=task))
    replay, passed_over = Replay(run), 0
    for entry, record in replay:
        assert compare(entry, record) == []
        match = record.decision.match
        if match is None or entry.decision.cause is not DecisionCause.RLA:
            continue
        nearest = replay.runtime.level.system.match(record.situation.vector)
        assert nearest is not None
        if nearest.rla.rla_id != match.rla.rla_id:
            assert hold_of(nearest.rla.origin.command_id) is not None
            facts = collect_facts(replay.runtime, record, lambda _: "").basic
            assert facts.nearest is not None
            assert facts.nearest.rla_id == match.rla.rla_id
            assert nearest.rla.rla_id not in [each.rla_id for each in facts.others]
            assert facts.passed_over is not None
            assert facts.passed_over.rla_id == nearest.rla.rla_id
            passed_over += 1
    assert passed_over > 0
