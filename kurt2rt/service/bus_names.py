"""Names in place of a bus and of a wire, in a module without imports: the command line offers them before any other."""

SIMULATED = "sim"
"""In place of a bus: a simulated robot in the same program."""
NO_WIRE = "none"
"""In place of a simulated wire: frames take no time, and nothing goes wrong."""
SHARED = "shared:"
"""Begins the name of a bus between programs of one user on this machine, where kurt2rt sim plays the robot."""
