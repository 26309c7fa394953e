"""The taught behaviour that the robot is to follow now."""

from kurt2rt.core.outcome import CommandRefusedError, RefusalCode


class ActiveBehaviour:
    """One of the behaviours that a task teaches: only its RLAs answer. A teacher, later a mid level, changes it."""

    def __init__(self, behaviours: tuple[str, ...] = ("",)) -> None:
        """`behaviours`: all that can be wanted, the first from the start; a task with one leaves it without a name."""
        self.behaviours = behaviours
        self.behaviour = behaviours[0]
        """The one that is wanted now."""

    def select(self, name: str) -> None:
        """Follow another behaviour from now on. Raises CommandRefusedError that lists them."""
        if name not in self.behaviours:
            raise CommandRefusedError(RefusalCode.NO_BEHAVIOUR, behaviour=name, known=self.behaviours)
        self.behaviour = name
