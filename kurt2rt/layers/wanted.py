"""Which taught behaviour the robot is to follow now."""


class Wanted:
    """One of the behaviours that a task teaches: only its RLAs answer. A teacher, later a mid level, changes it."""

    def __init__(self, behaviours: tuple[str, ...] = ("",)) -> None:
        """`behaviours`: all that can be wanted, the first from the start; a task with one leaves it without a name."""
        self.behaviours = behaviours
        self.behaviour = behaviours[0]
        """The one that is wanted now."""

    def pursue(self, name: str) -> None:
        """Want another one from now on. Raises ValueError that lists them."""
        if name not in self.behaviours:
            known = ", ".join(self.behaviours) or "one, without a name"
            raise ValueError(f"there is no taught behaviour {name!r}; this task has: {known}")
        self.behaviour = name
