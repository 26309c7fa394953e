"""Names that stand for a bus or a wire; without imports, because the command line reads them first."""

SIMULATED = "sim"
"""Bus name of a robot simulated in the same program."""
NO_WIRE = "none"
"""Wire name of ideal transport: frames arrive at once, none is lost."""
SHARED = "shared:"
"""Prefix of a bus between programs of one user on this machine, such as kurt2rt sim and kurt2rt run."""
