"""Active behaviour: the taught behaviour that the robot follows now."""

from kurt2rt.core.outcome import CommandRefusedError, RefusalCode


class ActiveBehaviour:
    """Selection of one of a task's taught behaviours, such as turn_left; only its RLAs compete.

    Both levels share one: a teacher's `Pursue` or the mid level sets it, the basic level reads it. A task with a single
    behaviour has the name "".
    """

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
