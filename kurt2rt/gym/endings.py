"""Endings of an episode."""

from collections.abc import Collection
from enum import StrEnum

from config.settings import SettingsError


class Ending(StrEnum):
    """Reason that an episode is over, as `info` names it."""

    COLLISION = "collision"
    """The robot touched a wall or an obstacle."""
    STUCK = "stuck"
    """The robot stayed in place for as long as ends an exam."""
    STOPPED = "stopped"
    """The robot stopped and waits for a teacher's resume, such as after an emergency stop of the guard."""
    OFF_COURSE = "off course"
    """The task cannot go on here, such as a left turn at a junction without a street to the left."""
    TIME = "time"
    """The time of the exam is over."""


INEVITABLE = frozenset({Ending.STOPPED, Ending.OFF_COURSE, Ending.TIME})
"""Endings of every environment."""

TERMINAL = frozenset({Ending.COLLISION, Ending.STUCK, Ending.STOPPED})
"""Endings by the agent's own doing (terminated); the others cut an episode short (truncated)."""

OPTIONAL = frozenset({Ending.COLLISION, Ending.STUCK})
"""Endings that the user of an environment may leave out."""


def read_endings(names: Collection[str]) -> frozenset[Ending]:
    """Return the endings with these names, and the inevitable ones.

    Raises config.settings.SettingsError for another name than collision or stuck.
    """
    unknown = sorted(set(names) - OPTIONAL)
    if unknown:
        raise SettingsError(
            f"ends_at: unknown ending (got {', '.join(unknown)}, allowed {', '.join(sorted(OPTIONAL))})"
        )
    return frozenset(Ending(name) for name in names) | INEVITABLE
