"""What errands came to, as it is kept."""

from hal.settings import Settings
from kurt2rt.experiments.kept.made_of import MadeOf


class ErrandDone(Settings):
    """One goal that a robot was sent to."""

    goal: str
    why_not: str
    """Empty where it came there."""
    seconds: float
    way_m: float
    shortest_m: float
    """From where it began to where it stopped; where it did not come there, to the middle of the goal's street."""
    junctions: int
    """On the shortest way."""
    demonstrated: float | None
    """The shortest way that it was led there in one piece, as a multiple of the shortest one; None: never."""
    surprises: int
    """How often it came to another place than planned."""
    collisions: int

    @property
    def reached(self) -> bool:
        """Whether it came there without touching anything."""
        return not self.why_not and not self.collisions

    @property
    def detour(self) -> float:
        """Way made, as a multiple of the shortest."""
        return self.way_m / self.shortest_m


class ErrandsOutcome(Settings):
    """One robot, led about and sent to goals."""

    made_of: MadeOf | None = None
    seed: int
    teaching_s: float
    ways: int
    """Taught, of all that the town has."""
    ways_in_all: int
    mid_rlas: int
    basic_rlas: int
    mid_asks: int
    missed_junctions: int
    corrections: int
    rescues: int
    named: int
    errands: dict[str, tuple[ErrandDone, ...]]
    """By how it went: by planning, and controls."""
