"""Recorded run with a slow lesson: replayed bit for bit, explained, and at full speed afterwards."""

from pathlib import Path

from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import load_task
from kurt2rt.core.teaching.commands import Resume, SetLessonSpeed, SetPhase, Watch
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.runs.explain.collect import collect_facts
from kurt2rt.runs.explain.reasons import format_reasons
from kurt2rt.runs.replay.comparison import compare
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.runs.replay.replay import Replay
from tests.runs.replay.stories import NAME, Scene, record_story


def slowly(scene: Scene, record: TickRecord) -> None:
    """Teach at 50 % from the start, at 80 % after 4 s, and let the robot drive in phase 3 after 6 s."""
    tick, inbox, say = record.tick, scene.runtime.inbox, scene.say
    if tick % 5 == 0:
        inbox.put(Watch(NAME, tick))
    scene.let_teach(record)
    match tick:
        case 10:
            say(lambda name: Resume(name, NAME))
        case 400:
            say(lambda name: SetLessonSpeed(name, NAME, 80))
        case 600:
            say(lambda name: SetPhase(name, NAME, Phase.REINFORCEMENT))


def test_run_with_a_slow_lesson_is_replayed_bit_for_bit(tmp_path: Path) -> None:
    task = load_task("wall_following", changes={"teaching.lesson_speed": "0.5"})
    run = read_run(record_story("walls", tmp_path, seconds=8, other=slowly, task=task))
    shares: dict[float, list[int]] = {}
    replay = Replay(run)
    for entry, record in replay:
        assert compare(entry, record) == []
        if record.decision.driving:
            shares.setdefault(record.lesson_speed, []).append(entry.tick)
            told = " ".join(format_reasons(collect_facts(replay.runtime, record, lambda _: "")))
            assert (f"{100 * record.lesson_speed:.0f} % of the speed" in told) is (record.lesson_speed < 1.0)
    assert list(shares) == [0.5, 0.8, 1.0]
    assert min(shares[1.0]) > 600
