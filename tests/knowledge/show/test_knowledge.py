import re
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console, RenderableType

from kurt2rt.core.rla.events import Appraised, TeachingEvent
from kurt2rt.core.rla.lesson_history import LessonRecord
from kurt2rt.core.rla.rla import CRITIC, Phase
from kurt2rt.core.rla.statistics import Statistics, follow_ups
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.show.knowledge import render_knowledge, render_lessons
from tests.knowledge.lessons import (
    BINDING,
    STAMP,
    WITH_CRITIC,
    appraisal,
    created,
    deleted,
    origin,
    replaced,
    rewarded,
    withdrawn,
)


def printed(what: RenderableType) -> list[str]:
    console = Console(width=250, color_system=None)
    with console.capture() as capture:
        console.print(what)
    return capture.get().splitlines()


def numbers(line: str) -> list[int]:
    return [int(each) for each in re.findall(r"\d+", line)]


def rows(lines: list[str]) -> list[list[str]]:
    """Cells of each RLA's row, empty ones left out."""
    return [re.split(r"\s{2,}", line.strip()) for line in lines if re.match(r"\s+\d+ ", line)]


def test_render_knowledge_has_teacher_time_and_former_action(path: Path) -> None:
    with Journal.open(path, BINDING) as journal:
        lessons: list[TeachingEvent] = [
            created(1),
            created(2),
            created(3),
            replaced(2, "left", instead_of="forward"),
            deleted(3),
        ]
        journal.append([JournalEntry(lesson, STAMP) for lesson in lessons])
        journal.checkpoint(Statistics({1: 41, 2: 7}, {(1, 2): 3, (1, 1): 1}))
        lines = printed(render_knowledge(journal))

    for part in ("wall following", "kurt2", " 4 ", "0123456789abcdef"):
        assert part in lines[0]
    assert numbers(lines[1])[:4] == [2, 5, 1, 1]
    assert "Hertha" in lines[1]
    first, second = rows(lines)
    when = STAMP[:19].replace("T", " ") + ", Hertha"
    assert first == [
        *("1", "forward", when, "1", "1", "41", "maximum front 81, wheel speed left -5, s1 0", "2 (75 %), 1 (25 %)"),
    ]
    assert second[:7] == ["2", "left", "forward", when, "2", "200", "7"]


def test_render_knowledge_has_withdrawals_values_appraisals(path: Path) -> None:
    critics = replace(rewarded(1, -1), origin=replace(rewarded(1).origin, teacher=CRITIC))
    events: list[TeachingEvent] = [
        *(created(number) for number in (1, 2, 3)),
        appraisal(4, (0.4, 0.2, 0.0)),
        appraisal(5, (0.0, 0.0, 1.0), "bad"),
        appraisal(6, (0.0, 0.0, 0.0), "neutral"),
        Appraised("good", 1, 395, origin("same-1", 400, Phase.CRITIC)),
        critics,
        withdrawn(1),
    ]
    with Journal.open(path, WITH_CRITIC) as journal:
        journal.append([JournalEntry(event, STAMP) for event in events])
        before = printed(render_knowledge(journal))
        journal.checkpoint(Statistics({1: 3}, values={1: -0.301, 3: 0.5}))
        lines = printed(render_knowledge(journal))
        fewer = printed(render_knowledge(journal, limit=2))
        lessons = "\n".join(printed(render_lessons(journal)))
        of_critic = printed(render_lessons(journal, taught_by=CRITIC))

    assert not any(re.search(r"rewards\s+value", line) for line in before)  # no reward has made one
    assert numbers(lines[1])[:9] == [3, 1, 3, 8, 0, 0, 1, 1, 1]
    assert " Hertha, critic, " in lines[1]
    when = STAMP[:19].replace("T", " ") + ", Hertha"
    first, second, third, *appraisals = rows(lines)
    assert first[:9] == ["1", "asks again", "forward", when, "3", "450", "3", "-1", "-0.30"]
    assert second[5] == "0"
    assert third[6] == "0.50"
    assert appraisals == [
        ["4", "good", when, "left_m 0.40, speed_m_s 0.20"],
        ["5", "bad", when, "bumped 1.00"],
        ["6", "neutral", when, "all 0"],
    ]
    assert any(re.search(r"\b1 .*\bcritic$", line) for line in fewer)
    assert LessonRecord(appraisal(5, action="bad"), level=CRITIC).text in lessons
    assert LessonRecord(withdrawn(1)).text in lessons
    assert [line.strip().split("  ")[0] for line in of_critic if "RLA" in line] == ["RLA 1 punished"]


def test_render_knowledge_without_lessons(path: Path) -> None:
    with Journal.open(path, BINDING) as journal:
        lines = printed(render_knowledge(journal))
    assert rows(lines) == []


def test_render_knowledge_names_cannot_control_the_terminal(path: Path) -> None:
    with Journal.open(path, BINDING) as journal:
        journal.append([JournalEntry(created(1, action="\x1b[2J[red]forward[/]"), STAMP)])
        text = "\n".join(printed(render_knowledge(journal)))

    assert "\N{REPLACEMENT CHARACTER}[2J[red]forward[/]" in text
    assert "\x1b" not in text


def test_follow_ups_are_shares_of_the_transitions() -> None:
    shares = follow_ups(Statistics({}, {(1, 2): 1, (1, 3): 3, (2, 2): 5, (4, 1): 0}))

    assert shares == {1: {3: 75.0, 2: 25.0}, 2: {2: 100.0}}
    assert list(shares[1]) == [3, 2]
    assert sum(shares[1].values()) == pytest.approx(100)
