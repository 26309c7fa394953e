"""Knowledge files made to hang, to fill the memory or to lose lessons: refused before a table is read."""

import os
from pathlib import Path

import pytest

from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from tests.knowledge.lessons import BINDING, begun, entry, tamper
from tests.knowledge.refusals import refused

ENDLESS = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n)"
STAYS = "CREATE TRIGGER lesson_stays BEFORE DELETE ON lesson"
DEEP = "[" * 100_000


ENDLESS_LESSONS = (
    f"{ENDLESS} SELECT i AS sequence, i AS command_id, '' AS stamped_at, '' AS event, 0 AS checksum FROM n"
)


@pytest.mark.parametrize(
    ("kind", "name", "statements"),
    [
        ("view", "lesson", ["DROP TABLE lesson", f"CREATE VIEW lesson AS {ENDLESS_LESSONS}"]),
        (
            "view",
            "binding",
            ["DROP TABLE binding", f"CREATE VIEW binding AS {ENDLESS} SELECT i AS key, i AS value FROM n"],
        ),
        ("trigger", "extra", ["CREATE TRIGGER extra AFTER INSERT ON lesson BEGIN UPDATE binding SET value = '' ; END"]),
        ("trigger", "lesson_stays", ["DROP TRIGGER lesson_stays", f"{STAYS} BEGIN SELECT 1; END"]),
        ("index", "mine", ["CREATE INDEX mine ON lesson (length(event))"]),
        ("table", "words", ["CREATE VIRTUAL TABLE words USING fts5(text)"]),
    ],
)
def test_open_foreign_schema_is_refused(path: Path, kind: str, name: str, statements: list[str]) -> None:
    tamper(begun(path), *statements)
    with refused(KnowledgeCode.FOREIGN_SCHEMA, kind=kind, name=name):
        Journal.open(path, BINDING)
    with refused(KnowledgeCode.FOREIGN_SCHEMA, kind=kind, name=name):
        Journal.read_only(path)


def test_open_table_of_a_newer_kurt2rt_is_ignored(path: Path) -> None:
    tamper(begun(path, lessons=1), "CREATE TABLE route (name TEXT PRIMARY KEY) STRICT, WITHOUT ROWID")
    with Journal.open(path, BINDING) as journal:
        journal.append([entry(2)])
        assert len(journal.events()) == 2


def test_open_deeply_nested_binding_is_refused(path: Path) -> None:
    tamper(begun(path), f"UPDATE binding SET value = '{DEEP}' WHERE key = 'feature_names'")
    with refused(KnowledgeCode.BINDING_DAMAGED):
        Journal.read_only(path)


def test_open_hard_link_is_refused(path: Path) -> None:
    second = path.with_name("second.knowledge")
    with Journal.open(path, BINDING) as journal:
        journal.append([entry(1)])
        os.link(path, second)
        with refused(KnowledgeCode.HARD_LINKS, names=2):
            Journal.open(second, BINDING)
        with refused(KnowledgeCode.HARD_LINKS, names=2):
            Journal.read_only(second)
        journal.append([entry(2)])
    second.unlink()
    with Journal.open(path, BINDING) as journal:
        assert len(journal.events()) == 2
