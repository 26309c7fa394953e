"""Knowledge with a mid level: in the same file, opened by every task of the same system, shown in words."""

import re
from dataclasses import replace
from pathlib import Path

from kurt2rt.core.mid.settings import load_mid_level
from kurt2rt.core.rla.events import RlaCreated, SituationNamed, TeachingEvent
from kurt2rt.core.rla.lesson_history import LessonRecord
from kurt2rt.core.rla.rla import MID, Rla
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.task_settings import load_task
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import open_for_teaching, open_knowledge, read_lessons
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.show.knowledge import render_knowledge, render_lessons
from tests.experiments.helpers import ROBOT
from tests.knowledge.lessons import BINDING, STAMP, created, origin, replaced, undone
from tests.knowledge.refusals import refused
from tests.knowledge.show.test_knowledge import printed, rows

STREETS = load_task("streets")
TURNS = load_mid_level("turns")
ROUTE = STREETS.model_copy(update={"name": "route", "system": "streets", "mid": "turns"})
ERRANDS = load_task("errands")


def basic(rla_id: int) -> RlaCreated:
    return RlaCreated(Rla(rla_id, (0.0,) * 72, "forward", None, origin(f"create-{rla_id}"), "turn_left"))


def mid_rla(rla_id: int, *symbols: int, action: str = "turn_left") -> RlaCreated:
    """Return an RLA for the situation after these symbols, the newest first."""
    condition = tuple(map(float, symbols)) + (0.0,) * (12 - len(symbols))
    return RlaCreated(Rla(rla_id, condition, action, None, origin(f"create-{rla_id}"), level=MID))


def write(path: Path, *events: TeachingEvent) -> None:
    with open_for_teaching(path, ROBOT, ROUTE).journal as journal:
        journal.append([JournalEntry(event, STAMP) for event in events])


def test_open_undone_lesson_still_binds_its_level(path: Path) -> None:
    write(path, basic(1), mid_rla(2, 1), undone("create-2"))
    with refused(KnowledgeCode.OTHER_LEVEL_FEATURES, level=MID):
        open_knowledge(path, ROBOT, ERRANDS)
    with refused(KnowledgeCode.OTHER_LEVEL_FEATURES, level=MID):
        read_lessons(path, ROBOT, ERRANDS)


def test_render_mid_level_has_words_teachers_and_successors(path: Path) -> None:
    write(
        path,
        *(basic(1), mid_rla(2), mid_rla(3, 2, 1), mid_rla(4, 3, 3, 4, action="straight_on")),
        corrected := replaced(4, "turn_right", instead_of="straight_on"),
    )
    with open_for_teaching(path, ROBOT, ROUTE).journal as journal:
        journal.checkpoint(Statistics({1: 7, 2: 3, 3: 1}, {(2, 3): 1, (2, 4): 3}))
        lines = printed(render_knowledge(journal))
        lessons = "\n".join(printed(render_lessons(journal)))

    when = STAMP[:19].replace("T", " ") + ", Hertha"
    assert re.findall(r"\d+", lines[1])[:3] == ["1", "3", "5"]
    ways = [row for row in rows(lines) if row[0] in {"2", "3", "4"}]
    assert (ways[0][:4], ways[0][5]) == (["2", "turn_left", when, "3"], "4 (75 %), 3 (25 %)")
    assert ways[1:] == [
        ["3", "turn_left", when, "1", "left, straight"],
        ["4", "turn_right", "straight_on", when, "0", "right, right, back"],
    ]
    assert LessonRecord(corrected, level=MID).text in lessons


def test_render_named_situations_have_present_meanings(path: Path) -> None:
    def named(name: str, *symbols: float, as_lesson: str) -> SituationNamed:
        return SituationNamed(name, symbols + (0.0,) * (12 - len(symbols)), MID, origin(as_lesson))

    write(path, named("door", 1.0, as_lesson="n-1"), named("attic", 2.0, 3.0, as_lesson="n-2"))
    write(path, named("door", 3.0, as_lesson="n-3"), named("yard", 1.0, as_lesson="n-4"), undone("n-4"))
    with Journal.read_only(path) as journal:
        lines = [line.split("  ") for line in printed(render_knowledge(journal))]
    cells = [[cell.strip() for cell in line if cell.strip()] for line in lines]
    assert cells[cells.index(["named", "where: the newest first"]) + 2 :][:2] == [
        ["attic", "left, right"],
        ["door", "right"],
    ]
    assert not any("yard" in line for line in cells)


def test_render_unknown_features_are_numbers(path: Path) -> None:
    with Journal.open(
        path, replace(BINDING, levels={MID: replace(TURNS.level_features, feature_hash="0123")})
    ) as journal:
        journal.append([JournalEntry(event, STAMP) for event in (created(1), mid_rla(2, 3, 1))])
        lines = printed(render_knowledge(journal, wide=False))
    assert any(re.search(r"^ +2 +turn_left .* symbol 1 3, symbol 2 1\s*$", line) for line in lines)
