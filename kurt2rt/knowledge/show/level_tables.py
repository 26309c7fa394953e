"""Tables of the RLAs of further levels, and of named situations."""

from collections.abc import Iterable, Mapping

from config.settings_files import shipped_names
from kurt2rt.core.mid.settings import MidSettings, load_mid_level
from kurt2rt.core.rla.condition import Condition, LevelFeatures
from kurt2rt.core.rla.rla import CRITIC, Rla
from kurt2rt.knowledge.journal.entry import StoredEntry
from kurt2rt.knowledge.show.table_cells import format_action, printable, replaced_action, stamp_and_teacher
from kurt2rt.platform.text_table import TextTable

_FOLLOW_UPS = 3


def mid_table(
    rlas: Iterable[Rla],
    features: LevelFeatures,
    taught: Mapping[str, StoredEntry],
    uses: Mapping[int, int],
    follow_ups: Mapping[int, Mapping[int, float]],
) -> TextTable:
    """Return the table of mid-level RLAs, a row each.

    A history is shown in words, the newest symbol first, if its settings are shipped; else in numbers.

    Args:
        rlas: of the mid level.
        features: of the mid level.
        taught: entry of each command id.
        uses: by RLA id.
        follow_ups: shares of an RLA's successors in percent, most frequent first.
    """
    settings = _shipped_mid(features.feature_hash)
    table = TextTable()
    table.add_column("mid-level RLA", number=True)
    for heading in ("behaviour", "instead of", "taught (UTC), by"):
        table.add_column(heading)
    table.add_column("uses", number=True)
    table.add_column("where: the newest first")
    table.add_column("followed by")
    for rla in rlas:
        entry = taught[rla.origin.command_id]
        following = list(follow_ups.get(rla.rla_id, {}).items())[:_FOLLOW_UPS]
        table.add_row(
            str(rla.rla_id),
            format_action(rla),
            replaced_action(entry),
            stamp_and_teacher(entry.stamped_at, rla.origin.teacher),
            str(uses.get(rla.rla_id, 0)),
            printable(_where(rla.condition, settings, features.feature_names)),
            ", ".join(f"{rla_id} ({percent:.0f} %)" for rla_id, percent in following),
        )
    return table


def named_table(named: Mapping[str, Condition], features: LevelFeatures) -> TextTable:
    """Return the table of named situations in alphabetical order, a row each.

    A history is shown in words if its settings are shipped; else in numbers.
    """
    settings = _shipped_mid(features.feature_hash)
    table = TextTable("named", "where: the newest first")
    for name in sorted(named):
        table.add_row(printable(name), printable(_where(named[name], settings, features.feature_names)))
    return table


def _shipped_mid(feature_hash: str) -> MidSettings | None:
    """Return the shipped mid level with these features, since a knowledge file holds no more than their fingerprint.

    None: settings of a user, or of another kurt2rt. Raises SettingsError.
    """
    shipped = map(load_mid_level, shipped_names("mid_levels"))
    return next((each for each in shipped if each.feature_hash == feature_hash), None)


def _where(situation: Condition, settings: MidSettings | None, feature_names: tuple[str, ...]) -> str:
    if settings is not None:
        words = [word for word in settings.situation.describe(situation) if word]
    else:
        named = zip(feature_names, situation, strict=True)
        words = [f"{name} {value:.3g}" for name, value in named if value]
    return ", ".join(words) or "at the beginning"


def level_table(
    level: str, rlas: Iterable[Rla], feature_names: tuple[str, ...], taught: Mapping[str, StoredEntry]
) -> TextTable:
    """Return the table of RLAs of a level, a row each; `taught` has the entry of each command id."""
    of_critic = level == CRITIC
    table = TextTable()
    table.add_column("appraisal RLA" if of_critic else f"{level} RLA", number=True)
    table.add_column("says" if of_critic else "action")
    for heading in ("instead of", "taught (UTC), by", "circumstances" if of_critic else "features"):
        table.add_column(heading)
    for rla in rlas:
        entry = taught[rla.origin.command_id]
        table.add_row(
            str(rla.rla_id),
            format_action(rla),
            replaced_action(entry),
            stamp_and_teacher(entry.stamped_at, rla.origin.teacher),
            printable(_circumstances(rla, feature_names)),
        )
    return table


def _circumstances(rla: Rla, feature_names: tuple[str, ...]) -> str:
    """Return the features that are not 0, by name."""
    named = zip(feature_names, rla.condition, strict=True)
    return ", ".join(f"{name} {value:.2f}" for name, value in named if value) or "all 0"
