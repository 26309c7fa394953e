"""Names that stand for a bus; without imports, because the command line reads them first."""

SIMULATED = "sim"
"""Bus name of a robot simulated in the same program."""
SHARED = "shared:"
"""Prefix of a bus between programs of one user on this machine, such as kurt2rt sim and kurt2rt run."""
