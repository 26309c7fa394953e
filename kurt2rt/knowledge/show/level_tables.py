"""Tables of the RLAs of each level, and of named situations."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from config.settings_files import shipped_names
from kurt2rt.core.mid.settings import MidSettings, load_mid_level
from kurt2rt.core.perception.definition import AVERAGED
from kurt2rt.core.rla.condition import LevelFeatures
from kurt2rt.core.rla.rla import CRITIC, MID
from kurt2rt.knowledge.show.table_cells import printable, stamp_and_teacher
from kurt2rt.platform.text_table import TextTable

RlaRow = dict[str, Any]
"""RLA in plain values, as `kurt2rt knowledge show --json` prints it."""

_FOLLOW_UPS = 3
_LARGEST_FEATURES = 3
_ID, _ACTION, _INSTEAD, _TAUGHT = "RLA", "action", "instead of", "taught (UTC), by"
_NUMBERS = ("phase", "tick", "uses", "rewards", "value")
_WHERE, _FOLLOWED, _LARGEST = "where: the newest first", "followed by", "largest features"


def basic_table(rlas: Sequence[RlaRow], *, any_value: bool, wide: bool) -> TextTable:
    """Return the table of the basic level's RLAs, a row each; `any_value`: rewards have given one of them a value."""
    columns = [_ID, *(["behaviour"] if any(each["behaviour"] for each in rlas) else []), _ACTION, _INSTEAD, _TAUGHT]
    tick = ["tick"] if wide or not any_value else []  # where there is no room for both
    columns += ["phase", *tick, "uses", "rewards", *(["value"] if any_value else [])]
    columns += [_LARGEST, _FOLLOWED] if wide else []
    return _table({heading: heading for heading in columns}, rlas, _CELLS)


def level_table(level: str, rlas: Iterable[RlaRow], features: LevelFeatures) -> TextTable:
    """Return the table of the RLAs of a further level, a row each.

    A history is shown in words, the newest symbol first, if its settings are shipped; else in numbers. Raises
    SettingsError.
    """
    settings = _shipped_mid(features.feature_hash)
    cells = {
        **_CELLS,
        _WHERE: lambda row: _where(row["condition"], settings),
        "features": lambda row: ", ".join(f"{n} {v:.2f}" for n, v in row["condition"].items() if v) or "all 0",
    }
    if level == MID:
        columns = {"mid-level RLA": _ID, "behaviour": _ACTION, _INSTEAD: _INSTEAD, _TAUGHT: _TAUGHT, "uses": "uses"}
        columns |= {_WHERE: _WHERE, _FOLLOWED: _FOLLOWED}
    elif level == CRITIC:
        columns = {"appraisal RLA": _ID, "says": _ACTION, _INSTEAD: _INSTEAD, _TAUGHT: _TAUGHT}
        columns["circumstances"] = "features"
    else:
        columns = {f"{level} RLA": _ID, _ACTION: _ACTION, _INSTEAD: _INSTEAD, _TAUGHT: _TAUGHT, "features": "features"}
    return _table(columns, rlas, cells)


def named_table(named: Mapping[str, Sequence[float]], features: LevelFeatures) -> TextTable:
    """Return the table of named situations in alphabetical order, a row each.

    A history is shown in words if its settings are shipped; else in numbers.
    """
    settings = _shipped_mid(features.feature_hash)
    table = TextTable("named", _WHERE)
    for name in sorted(named):
        situation = dict(zip(features.feature_names, named[name], strict=True))
        table.add_row(printable(name), printable(_where(situation, settings)))
    return table


def _table(
    columns: Mapping[str, str], rlas: Iterable[RlaRow], cells: Mapping[str, Callable[[RlaRow], str]]
) -> TextTable:
    """Return a table; `columns`: the name of the cells by heading."""
    table = TextTable()
    for heading, name in columns.items():
        table.add_column(heading, number=name in (_ID, *_NUMBERS))
    for row in rlas:
        table.add_row(*(printable(cells[name](row)) for name in columns.values()))
    return table


_CELLS: Mapping[str, Callable[[RlaRow], str]] = {
    _ID: lambda row: str(row["rla"]),
    "behaviour": lambda row: row["behaviour"],
    _ACTION: lambda row: "asks again" if row["asks"] else row["action"],
    _INSTEAD: lambda row: row["instead_of"],
    _TAUGHT: lambda row: stamp_and_teacher(row["taught_at"], row["teacher"]).plain,
    "phase": lambda row: str(row["phase"]),
    "tick": lambda row: str(row["tick"]),
    "uses": lambda row: str(row["uses"]),
    "rewards": lambda row: " ".join(
        f"{sign}{count}" for sign, count in (("+", row["rewards"]), ("-", row["punishments"])) if count
    ),
    "value": lambda row: "" if row["value"] is None else f"{row['value']:.2f}",
    _LARGEST: lambda row: _largest_features(row["condition"]),
    _FOLLOWED: lambda row: ", ".join(
        f"{rla_id} ({percent:.0f} %)" for rla_id, percent in list(row["followed_by_percent"].items())[:_FOLLOW_UPS]
    ),
}
"""Text of each cell of a row."""


def _shipped_mid(feature_hash: str) -> MidSettings | None:
    """Return the shipped mid level with these features, since a knowledge file holds no more than their fingerprint.

    None: settings of a user, or of another kurt2rt. Raises SettingsError.
    """
    shipped = map(load_mid_level, shipped_names("mid_levels"))
    return next((each for each in shipped if each.feature_hash == feature_hash), None)


def _where(situation: Mapping[str, float], settings: MidSettings | None) -> str:
    if settings is not None:
        words = [word for word in settings.situation.describe(tuple(situation.values())) if word]
    else:
        words = [f"{name} {value:.3g}" for name, value in situation.items() if value]
    return ", ".join(words) or "at the beginning"


def _largest_features(condition: Mapping[str, float]) -> str:
    """Return the recent features farthest from 0: a high count is a near obstacle, a wheel speed may be negative."""
    recent = [feature for feature in condition.items() if not feature[0].endswith(AVERAGED)]
    largest = sorted(recent, key=lambda feature: -abs(feature[1]))[:_LARGEST_FEATURES]
    return ", ".join(f"{name} {value:.0f}" for name, value in largest)
