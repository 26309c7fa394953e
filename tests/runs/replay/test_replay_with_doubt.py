"""Recorded run of a robot that doubts: replayed bit for bit, and explained."""

import re
from pathlib import Path

from kurt2rt.channel.protocol.codec import FACTS
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import load_task
from kurt2rt.core.teaching.commands import Resume, SetPhase, Teach, Watch
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.runs.explain.collect import collect_facts
from kurt2rt.runs.explain.reasons import format_reasons
from kurt2rt.runs.replay.comparison import compare
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.runs.replay.replay import Replay
from simbridge.contracts.simulation import Pose
from tests.runs.replay.stories import NAME, Scene, record_story


def drives_to_a_wall_alone(scene: Scene, record: TickRecord) -> None:
    """Teach forward far from walls and a turn with a wall on the right; then drive to a wall in phase 5."""
    inbox, tick = scene.runtime.inbox, record.tick
    if tick == 1:
        scene.simulation.put(Pose(2.0, 2.0, 0.0))
        inbox.put(Resume("go", NAME))
    inbox.put(Watch(NAME, tick))
    if tick in (20, 40):
        inbox.put(Teach(f"t{tick}", NAME, "forward"))
    if tick == 50:
        scene.simulation.put(Pose(2.0, 0.30, 0.0))
    if tick == 60:
        inbox.put(Teach("turn", NAME, "spin_right"))
    if tick == 70:
        scene.simulation.put(Pose(2.0, 2.0, 0.0))
        scene.runtime.reposition()
        inbox.put(SetPhase("alone", NAME, Phase.AUTONOMOUS))


STANDS_ALONE = {
    "learning.radius": "2000",
    "learning.doubt.asks": "true",
    "learning.doubt.alone": "true",
    "learning.doubt.contact.within_s": "1.0",
}


def test_run_standing_in_doubt_is_replayed_and_explained(tmp_path: Path) -> None:
    task = load_task("wall_following", changes=STANDS_ALONE)
    run = read_run(record_story("walls", tmp_path, seconds=9, other=drives_to_a_wall_alone, task=task))
    causes = list[DecisionCause]()
    replay = Replay(run)
    for entry, record in replay:
        assert compare(entry, record) == []
        causes.append(entry.decision.cause)
        if entry.decision.cause is DecisionCause.DOUBT:
            facts = collect_facts(replay.runtime, record, lambda _: "")
            assert FACTS.read(FACTS.plain_of(facts)) == facts
            assert re.search(r"forward would meet in .* what front", format_reasons(facts)[0])
    assert causes[-1] is DecisionCause.DOUBT
