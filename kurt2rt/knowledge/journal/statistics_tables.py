"""Tables of the statistics in a knowledge file, and the statements that write changes of them."""

import sqlite3
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from kurt2rt.core.rla.statistics import Expectation, Statistics

STATISTICS_TABLES = """
CREATE TABLE uses (rla_id INTEGER PRIMARY KEY, count INTEGER NOT NULL) STRICT;
CREATE TABLE transition (
    from_rla INTEGER NOT NULL, to_rla INTEGER NOT NULL, count INTEGER NOT NULL, PRIMARY KEY (from_rla, to_rla)
) STRICT, WITHOUT ROWID;
CREATE TABLE value (rla_id INTEGER PRIMARY KEY, value REAL NOT NULL) STRICT;
CREATE TABLE number (name TEXT PRIMARY KEY, value REAL NOT NULL) STRICT, WITHOUT ROWID;
CREATE TABLE expectation (
    rla_id INTEGER PRIMARY KEY, lesson TEXT NOT NULL, count INTEGER NOT NULL, ticks REAL NOT NULL,
    mean BLOB NOT NULL, squares BLOB NOT NULL
) STRICT;
CREATE TABLE answer_delay (
    teacher TEXT NOT NULL, place INTEGER NOT NULL, ticks INTEGER NOT NULL, PRIMARY KEY (teacher, place)
) STRICT, WITHOUT ROWID;
"""
"""SQL that creates the tables."""


class TableChange(NamedTuple):
    """SQL statement of a checkpoint, and the rows that it is executed for."""

    statement: str
    rows: Sequence[tuple[float | str | bytes, ...]]


class _Table(NamedTuple):
    """Table of one value per key."""

    name: str
    columns: tuple[str, ...]
    """Those of the key, then the one of the value."""

    def read(self, connection: sqlite3.Connection) -> dict[Any, Any]:
        """Return the content by key (RLA id, pair of RLA ids, or name)."""
        columns, keys = ", ".join(self.columns), ", ".join(self.columns[:-1])
        rows = connection.execute(f"SELECT {columns} FROM {self.name} ORDER BY {keys}")
        return {key[0] if len(key) == 1 else tuple(key): value for *key, value in rows}

    def changes(self, before: Mapping[Any, float], after: Mapping[Any, float]) -> list[TableChange]:
        """Return the statements that turn the content `before` into `after`."""
        keys = " AND ".join(f"{column} = ?" for column in self.columns[:-1])
        marks = ", ".join("?" for _ in self.columns)
        gone = [_key(key) for key in before.keys() - after.keys()]
        written = [(*_key(key), value) for key, value in after.items() if before.get(key) != value]
        both = [
            TableChange(f"DELETE FROM {self.name} WHERE {keys}", gone),
            TableChange(f"INSERT OR REPLACE INTO {self.name} VALUES ({marks})", written),
        ]
        return [change for change in both if change.rows]


_USES = _Table("uses", ("rla_id", "count"))
_TRANSITIONS = _Table("transition", ("from_rla", "to_rla", "count"))
_VALUES = _Table("value", ("rla_id", "value"))
_NUMBERS = _Table("number", ("name", "value"))
_ANSWER_DELAYS = _Table("answer_delay", ("teacher", "place", "ticks"))
"""Place 0 is a teacher's oldest time."""


def read_statistics(connection: sqlite3.Connection) -> Statistics:
    """Return the statistics in the file's tables; empty before the first checkpoint. Raises sqlite3.Error."""
    return Statistics(
        _USES.read(connection),
        _TRANSITIONS.read(connection),
        _VALUES.read(connection),
        _NUMBERS.read(connection),
        _read_expectations(connection),
        _read_answer_delays(connection),
    )


def changes(before: Statistics, after: Statistics) -> list[TableChange]:
    """Return the statements that turn `before` into `after`: only rows that differ, to spare the flash disk."""
    return [
        *_USES.changes(before.uses, after.uses),
        *_TRANSITIONS.changes(before.transitions, after.transitions),
        *_VALUES.changes(before.values, after.values),
        *_NUMBERS.changes(before.numbers, after.numbers),
        *_expectation_changes(before.expectations, after.expectations),
        *_ANSWER_DELAYS.changes(_by_place(before.answer_delays), _by_place(after.answer_delays)),
    ]


def _by_place(delays: Mapping[str, Sequence[int]]) -> dict[tuple[str, int], int]:
    return {(teacher, place): ticks for teacher, took in delays.items() for place, ticks in enumerate(took)}


def _read_answer_delays(connection: sqlite3.Connection) -> dict[str, tuple[int, ...]]:
    delays: dict[str, tuple[int, ...]] = {}
    for (teacher, _), ticks in _ANSWER_DELAYS.read(connection).items():
        delays[teacher] = (*delays.get(teacher, ()), ticks)
    return delays


def _key(key: int | str | tuple[int | str, ...]) -> tuple[int | str, ...]:
    return key if isinstance(key, tuple) else (key,)


def _read_expectations(connection: sqlite3.Connection) -> dict[int, Expectation]:
    rows = connection.execute("SELECT rla_id, lesson, count, ticks, mean, squares FROM expectation ORDER BY rla_id")
    return {rla_id: Expectation(*values) for rla_id, *values in rows}


def _expectation_changes(before: Mapping[int, Expectation], after: Mapping[int, Expectation]) -> list[TableChange]:
    """Return the changes; an expectation that is the same object is skipped, so a large table takes microseconds."""
    gone = [(rla_id,) for rla_id in before.keys() - after.keys()]
    written = [
        (rla_id, each.lesson, each.count, each.ticks, each.packed_mean, each.packed_squares)
        for rla_id, each in after.items()
        if before.get(rla_id) is not each and before.get(rla_id) != each
    ]
    both = [
        TableChange("DELETE FROM expectation WHERE rla_id = ?", gone),
        TableChange("INSERT OR REPLACE INTO expectation VALUES (?, ?, ?, ?, ?, ?)", written),
    ]
    return [change for change in both if change.rows]
