"""Names of the programs that teach: in a journal they stand in place of a person's name."""

from kurt2rt.core.rla.rla import CRITIC

AUTO = "auto"
"""Scripted teacher on its own device."""
SCRIPTED = "scripted teacher"
"""Scripted teacher of an experiment, in the robot's process."""
PROGRAMS = frozenset({AUTO, SCRIPTED, CRITIC})
"""Teachers in a journal that are programs."""
