"""One RLA, whole."""

import re
from pathlib import Path

import numpy as np
from rich.console import Console

from kurt2rt.core.rla.statistics import Expectation, Statistics, pack
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.show.rla import render_rla
from tests.knowledge.lessons import BINDING, begun
from tests.knowledge.refusals import refused


def shown(path: Path, rla_id: int, limit: int | None = None) -> str:
    console = Console(width=100)
    with console.capture() as capture, Journal.read_only(path) as journal:
        console.print(render_rla(journal, rla_id, limit))
    return capture.get()


def taught(path: Path, lesson: str = "create-1") -> Path:
    """Its first RLA was seen to end; in it the condition is 1/3, 0.1, 81, -5."""
    mean, squares = np.array([0.5, 300.0, 81.0, -5.0]), np.array([0.0, 3 * 40.0**2, 0.0, 0.0])
    with Journal.open(begun(path), BINDING) as journal:
        ends = Expectation(lesson, 4, 35.0, pack(mean), pack(squares))
        journal.checkpoint(Statistics({1: 5}, {(1, 2): 3, (1, 3): 1}, expectations={1: ends}))
    return path


def test_render_rla_has_action_successors_and_expectation(path: Path) -> None:
    text = shown(taught(path), 1)
    assert re.search(r"RLA 1: forward,.* Hertha .*\b1\b.*\b5\b", text)
    assert "2 (75 %), 3 (25 %)" in text
    assert re.search(r"\b4 .*\b0\.35 s", text)
    rows = [line.split() for line in text.splitlines()]
    assert ["s2", "0.1", "300", "±40"] in rows
    assert ["wheel", "speed", "left", "-5", "-5", "±0"] in rows


def test_render_rla_unknown_id_is_refused(path: Path) -> None:
    with refused(KnowledgeCode.NO_SUCH_RLA, rla_id=9):
        shown(begun(path), 9)
