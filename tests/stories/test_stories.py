"""Stories of many faults at once: everything holds, a seed tells the same again, what breaks is found and shrunk."""

import asyncio
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import get_args

import pytest

from hal.guard import Guard
from hal.points import Point
from kurt2rt.knowledge.journal.entry import JournalEntry, Receipt
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.platform.memory import pin_mmap_threshold
from tests.processors import OF_2004
from tests.stories.shrink import shrunk
from tests.stories.story import Event, Story, Teaching, all_kinds, as_text, load_story, story_of
from tests.stories.table import TARGETS
from tests.stories.teller import tell

SHORT_S = 10.0
MOST_GROWN_MB = 5.0


@pytest.mark.parametrize("tens", range(5))
async def test_short_stories(tens: int, tmp_path: Path) -> None:
    for seed in range(10 * tens, 10 * tens + 10):
        folder = tmp_path / str(seed)
        folder.mkdir()
        assert (await tell(story_of(seed, SHORT_S), folder)).problems == [], seed


def test_stories_have_all_kinds_and_points() -> None:
    stories = [story_of(seed, SHORT_S) for seed in range(1000)]
    assert {(each.target, each.kind) for story in stories for each in story.faults} == set(all_kinds())
    assert {point for story in stories for point in story.points} == set(get_args(Point))


@pytest.mark.parametrize("seed", [1, 2])
def test_a_story_is_the_same_as_a_file(seed: int, tmp_path: Path) -> None:
    story = story_of(seed, SHORT_S)
    file = tmp_path / "story.yaml"
    file.write_text(as_text(story), encoding="utf-8")
    assert load_story(file) == story


def told_by_a_process(file: Path, environment: dict[str, str]) -> str:
    words = [sys.executable, "-m", "tests.stories", str(file)]
    return subprocess.run(words, env=os.environ | environment, capture_output=True, text=True, check=True).stdout


def test_a_story_ends_equal_on_another_processor(tmp_path: Path) -> None:
    """And in a process that has told others before."""
    story, file, folder = story_of(5, SHORT_S), tmp_path / "story.yaml", tmp_path / "here"
    file.write_text(as_text(story), encoding="utf-8")
    folder.mkdir()
    end = f"everything held\nhash {asyncio.run(tell(story, folder)).hash}\n"
    assert told_by_a_process(file, {"PYTHONHASHSEED": "1"}) == end
    assert told_by_a_process(file, {"PYTHONHASHSEED": "2", **OF_2004}) == end


@pytest.mark.deep
@pytest.mark.timeout(3600)
async def test_half_an_hour_takes_no_memory(tmp_path: Path) -> None:
    pin_mmap_threshold()  # as the robot's program does
    faults = tuple(Event(at_s=60.0 * minute, target="bus_in", kind="garbage", lasts_s=5.0) for minute in range(1, 29))
    story = Story(seed=2, lasts_s=1800.0, taught=True, faults=faults)
    told = await tell(story, tmp_path)
    assert told.problems == []
    assert len(told.resident_mb) == 30
    assert median(told.resident_mb[-10:]) - median(told.resident_mb[5:15]) <= MOST_GROWN_MB


async def test_a_guard_that_lets_go_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Guard, "latched", None)
    monkeypatch.setattr(Guard, "emergency_stop", lambda *_: None)
    faults = tuple(Event(at_s=at_s, target="tick", kind="stuck", lasts_s=1.0) for at_s in (3.0, 5.0))
    story = Story(seed=2, lasts_s=SHORT_S, taught=True, faults=faults)
    assert (await tell(story, tmp_path)).problems


async def test_a_journal_that_says_too_much_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    append = Journal.append

    def forget(journal: Journal, entries: Sequence[JournalEntry], _: object = None) -> list[Receipt]:
        forgotten = [Receipt(each.event.origin.command_id, 1, each.stamped_at, True, True) for each in entries[-1:]]
        return append(journal, entries[:-1]) + forgotten

    monkeypatch.setattr(Journal, "append", forget)
    story = Story(seed=1, lasts_s=SHORT_S)
    problems = (await tell(story, tmp_path)).problems
    assert any("gone" in each for each in problems), problems


async def test_shrinking_leaves_what_breaks() -> None:
    """Two faults that overlap break it, of twelve."""
    story = story_of(3, 60.0)
    faults = tuple(
        Event(at_s=2.0 * number, target=target, kind="off", lasts_s=3.0) for number, target in enumerate(TARGETS)
    )
    tries = 0

    async def breaks(tried: Story) -> str:
        nonlocal tries
        tries += 1
        targets = {each.target for each in tried.faults}
        return f"at {tries}.5 s /tmp/{tries} breaks" if {"encoders", "bus_out"} <= targets else ""

    shortest = await shrunk(story.model_copy(update={"robot": "school", "faults": faults}), breaks)
    assert [each.target for each in shortest.faults] == ["encoders", "bus_out"]
    assert all(each.lasts_s < 0.1 for each in shortest.faults)
    plain = shortest.robot, shortest.world, shortest.points, shortest.teaching
    assert plain == ("kurt2", "a", (), Teaching(phase=2, reaction_s=0.5, error_rate=0.0))
    assert tries < 80
