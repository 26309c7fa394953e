"""Runs in which actions were held and presses came late are decided again as they were."""

from collections.abc import Mapping
from pathlib import Path

import pytest

from kurt2rt.core.outcome import Field
from kurt2rt.core.rla.events import ActionReplaced, LessonUndone, RlaCreated
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.teaching.commands import Correct, HoldAction, Resume, SetPhase, Stop, Undo, Watch
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.runs.recording.entries import TickEntry
from kurt2rt.runs.replay.comparison import compare
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.runs.replay.replay import Replay
from tests.runs.replay.stories import NAME, Scene, record_story

ANSWERED = (50, 60, 60, 60)
"""Times of the teacher's answers in an earlier run, in ticks."""


def holding(scene: Scene, record: TickRecord) -> None:
    """Let the teacher answer for 5 s, hold an action for a second, press late, and undo the hold."""
    tick, inbox, say = record.tick, scene.runtime.inbox, scene.say
    if tick % 5 == 0:
        inbox.put(Watch(NAME, tick))
    if tick < 500 or tick > 640:
        scene.let_teach(record)
    if 500 <= tick < 600:
        inbox.put(HoldAction(NAME, tick, 1, "curve_left" if tick < 560 else "curve_right"))
    match tick:
        case 10:
            say(lambda name: Resume(name, NAME))
            say(lambda name: SetPhase(name, NAME, Phase.CORRECTIONS))
        case 605:
            say(lambda name: Stop(name, NAME, 1))
        case 620:
            say(lambda name: Correct(name, NAME, "curve_left", late=True, seen_tick=tick))
        case 660:
            say(lambda name: Undo(name, NAME, f"{NAME}-hold-1"))


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs")
    return record_story("walls", folder, seconds=8, other=holding, saved=Statistics(answer_delays={NAME: ANSWERED}))


def test_replay_of_holds_and_late_presses_is_bit_exact(run_folder: Path) -> None:
    found = list[str]()
    late: Mapping[str, Field] = {}
    for entry, record in Replay(read_run(run_folder)):
        found += [str(each) for each in compare(entry, record)]
        if entry.tick == 621:
            late = record.results[0].outcome.fields
    assert found == []
    assert late["put_back_ticks"]
    assert late["delay_answers"] == len(ANSWERED) + 1


def test_recorded_hold_has_its_lessons_and_their_undo(run_folder: Path) -> None:
    entries: list[TickEntry] = list(read_run(run_folder).entries())
    events = [event for entry in entries for event in entry.events]
    given = [
        event.origin.command_id
        for event in events
        if isinstance(event, RlaCreated | ActionReplaced) and "-hold-1/" in event.origin.command_id
    ]
    undone = [event.lesson for event in events if isinstance(event, LessonUndone)]
    assert len(given) > 1
    assert undone == given[::-1]
    assert next(entry.results[0] for entry in entries if entry.tick == 621).accepted
