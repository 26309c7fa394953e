"""A knowledge file that a worn disk changed anywhere is refused in a sentence and left alone, or it is all there."""

import random
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

from kurt2rt.core.rla.events import RlaCreated
from kurt2rt.core.rla.rla import Rla
from kurt2rt.core.rla.statistics import BEST_SCORE, Statistics
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.loading import open_for_teaching, open_knowledge
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from tests.crash.power_cut import SECTOR_BYTES
from tests.experiments.helpers import ROBOT, short_task
from tests.knowledge.lessons import STAMP, origin

LESSONS = 40
PAGE_BYTES = 4096


def taught(path: Path) -> list[RlaCreated]:
    with open_knowledge(path, ROBOT, short_task()) as journal:
        features = len(journal.binding.feature_names)
        lessons = [
            RlaCreated(Rla(number, (number / 7,) * features, "forward", None, origin(f"c{number}")))
            for number in range(1, LESSONS + 1)
        ]
        journal.append([JournalEntry(lesson, STAMP) for lesson in lessons])
        journal.checkpoint(Statistics({1: 5, 2: 7}, {(1, 2): 3}, {1: 0.25}, {BEST_SCORE: 90.0}))
    return lessons


def damaged(whole: bytes, chance: random.Random) -> Iterator[tuple[str, bytes]]:
    """Yield damaged files: truncated, a sector lost or foreign, a page in another page's place."""
    for at in range(0, len(whole), SECTOR_BYTES):
        rest = whole[at + SECTOR_BYTES :]
        elsewhere = (at + PAGE_BYTES) % len(whole)
        yield f"cut at {at}", whole[:at]
        yield f"zeros at {at}", whole[:at] + bytes(SECTOR_BYTES) + rest
        yield f"rubble at {at}", whole[:at] + chance.randbytes(SECTOR_BYTES) + rest
        yield f"another sector at {at}", whole[:at] + whole[elsewhere : elsewhere + SECTOR_BYTES] + rest
    for at in range(0, len(whole), PAGE_BYTES):
        for other in range(0, len(whole), PAGE_BYTES):
            if other != at:
                page = whole[other : other + PAGE_BYTES]
                yield f"page {other} at {at}", whole[:at] + page + whole[at + PAGE_BYTES :]


def look_at_all(path: Path, every: int) -> Counter[str]:
    lessons = taught(path)
    whole = path.read_bytes()
    outcomes: Counter[str] = Counter()
    for number, (what, content) in enumerate(damaged(whole, random.Random(1))):
        if number % every:
            continue
        for each in path.parent.iterdir():
            each.unlink()
        path.write_bytes(content)
        try:
            opened = open_for_teaching(path, ROBOT, short_task())
        except KnowledgeError as error:
            said = str(error)
        else:
            said = ""
            with opened.journal:
                assert opened.events == lessons, what
        if said:
            assert str(path) in said, what
            assert "\n" not in said, what
            assert "; " in said, what
            assert path.read_bytes() == content, what
        outcomes["refused" if said else "all there"] += 1
    return outcomes


def test_damage_is_told_or_does_not_matter(tmp_path: Path) -> None:
    outcomes = look_at_all(tmp_path / "knowledge", every=41)
    assert outcomes["refused"] > outcomes["all there"] > 0


@pytest.mark.deep
def test_all_damage_is_told_or_does_not_matter(tmp_path: Path) -> None:
    outcomes = look_at_all(tmp_path / "knowledge", every=1)
    print(dict(outcomes))
    assert outcomes["refused"] > outcomes["all there"] > 0
