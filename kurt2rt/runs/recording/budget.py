"""Disk space of recordings."""

from dataclasses import dataclass

MEGA = 1_000_000


@dataclass(frozen=True, slots=True)
class Budget:
    """Limits of the disk space that recordings may take."""

    total_bytes: int
    """Limit of all runs together."""
    segment_bytes: int
    """Size at which the next segment is started."""
    reserve_bytes: int = 200 * MEGA
    """Free space kept for lessons: below it recordings are deleted, then suspended."""


def budget_of(megabytes: int) -> Budget:
    """Return a budget of `megabytes` for all runs."""
    return Budget(megabytes * MEGA, min(32 * MEGA, megabytes * MEGA // 10))
