"""Active behaviour: the taught behaviour that the robot follows now."""

from kurt2rt.core.outcome import CommandRefusedError, RefusalCode


class ActiveBehaviour:
    """Selection of one of a task's taught behaviours; only its RLAs compete. A teacher or the mid level changes it."""

    def __init__(self, behaviours: tuple[str, ...] = ("",)) -> None:
        """`behaviours`: names to select from, the first active at the start; a single behaviour has no name."""
        self.behaviours = behaviours
        self.behaviour = behaviours[0]
        """Name of the active one."""

    def select(self, name: str) -> None:
        """Make another behaviour active. Raises CommandRefusedError, which lists the names."""
        if name not in self.behaviours:
            raise CommandRefusedError(RefusalCode.NO_BEHAVIOUR, behaviour=name, known=self.behaviours)
        self.behaviour = name
