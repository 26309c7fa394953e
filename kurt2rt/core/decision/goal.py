"""What a teacher can send the robot to."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class NamedGoal:
    """A situation that the teacher has named: door, this junction."""

    name: str

    @property
    def text(self) -> str:
        """In words."""
        return self.name


@dataclass(frozen=True, slots=True)
class RlaGoal:
    """The situation that an RLA of the mid level knows."""

    rla_id: int

    @property
    def text(self) -> str:
        """In words."""
        return f"the situation of RLA {self.rla_id}"


@dataclass(frozen=True, slots=True)
class PartialGoal:
    """Any situation in which some features are as wanted, such as a wall on the left."""

    features: tuple[tuple[str, float], ...]
    """Names of features of the mid level's situation, and the values they are to have."""
    tolerance: float = 0.0
    """How far each may be off."""

    @property
    def text(self) -> str:
        """In words."""
        return " and ".join(f"{name} {value:g}" for name, value in self.features)


Goal = NamedGoal | RlaGoal | PartialGoal
