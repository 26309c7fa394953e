"""Leagues of `kurt2rt rivals`: names of their rivals, by what a teacher gives."""

from collections.abc import Mapping
from enum import StrEnum

from kurt2rt.experiments.rivals.agents.rows import AGENTS
from kurt2rt.experiments.rivals.holds.rows import TITLES as HOLDS
from kurt2rt.experiments.rivals.rival import ACTS, ASKS_AT_RANDOM, PLAIN, SHIPPED, TUNED, Rival
from kurt2rt.experiments.rivals.signals.rows import TITLES as SIGNALS


class LeagueName(StrEnum):
    """League, by what its rivals get from a teacher."""

    PRESSES = "presses"
    """One label for each answer and each correction."""
    HOLDS = "holds"
    """The teacher takes charge of the robot, drives it by held actions, and gives it back."""
    SIGNALS = "signals"
    """Rewards of +1 and -1 by the judge of the task, and nothing else: a teacher's few, or those of each decision."""
    ALL = "all"
    """The three leagues, on one page."""


TITLES: Mapping[LeagueName, str] = {
    LeagueName.PRESSES: "Taught by presses",
    LeagueName.HOLDS: "Taught by a teacher in charge",
    LeagueName.SIGNALS: "Taught by rewards",
}
"""Title of each league but `ALL`, in the order of a page."""
_ROWS: Mapping[LeagueName, tuple[str, ...]] = {
    LeagueName.PRESSES: (
        SHIPPED,
        TUNED,
        PLAIN,
        ACTS,
        "1-nn",
        "k-nn",
        "weighted-vote",
        "vote-without-gate",
        ASKS_AT_RANDOM,
        "gp",
        "svm",
        "tree",
        "forest",
        "hoeffding",
        "arf",
        "mlp-ensemble",
    ),
    LeagueName.HOLDS: (SHIPPED, *HOLDS),
    LeagueName.SIGNALS: (SHIPPED, *SIGNALS, *AGENTS),
}


def rows_of_league(name: LeagueName) -> tuple[str, ...]:
    """Return the names of the rivals of a league, each once, in the order of the tables."""
    if name is LeagueName.ALL:
        return tuple(dict.fromkeys(row for rows in _ROWS.values() for row in rows))
    return _ROWS[name]


def league_of(rival: Rival) -> LeagueName:
    """Return the league of a rival, by what a teacher gives it. Raises NoLearnerError."""
    if rival.is_held:
        return LeagueName.HOLDS
    return LeagueName.SIGNALS if rival.is_rewarded or rival.is_agent else LeagueName.PRESSES
