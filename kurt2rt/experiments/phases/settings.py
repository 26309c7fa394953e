"""Schema of the section `phases` of a task."""

PHASES = ("phases", "judge", "reinforcement", "critic")
"""Parts of a task that phases 1 and 2 have nothing to do with."""
