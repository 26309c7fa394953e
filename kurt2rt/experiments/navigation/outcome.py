"""What errands came to, as it is kept."""

from typing import Literal

from hal.settings import Settings
from kurt2rt.experiments.study.provenance import Provenance

Place = tuple[float, float]
"""x and y in m, to the millimetre."""

Strategy = Literal["planning", "chance", "first taught"]
"""By what the robot goes: a plan; or, as controls, any of the ways that were taught at a place, by chance; or always
the one that was taught first."""


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
        return self.way_m / max(self.shortest_m, 0.1)


class ErrandsRun(Settings):
    """All goals, one after the other."""

    how: Strategy
    errands: tuple[ErrandDone, ...]
    trail: tuple[Place, ...]

    def good(self, detour_at_most: float) -> int:
        """How many goals were reached by a way that is short enough."""
        return sum(each.reached and each.detour <= detour_at_most for each in self.errands)

    @property
    def reached(self) -> tuple[ErrandDone, ...]:
        """Those that were reached, however long the way."""
        return tuple(each for each in self.errands if each.reached)


class ErrandsOutcome(Settings):
    """One robot, led about and sent to goals."""

    made_of: Provenance | None = None
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
    named: dict[str, Place]
    """Where each name was given: beside the middle of the street, to the right."""
    led: tuple[Place, ...]
    """Where it was led."""
    knowledge_hash: str
    runs: tuple[ErrandsRun, ...]
    """By planning, and controls."""

    def run_of(self, how: Strategy) -> ErrandsRun | None:
        """How it went by one of these; None where it was not tried."""
        return next((each for each in self.runs if each.how == how), None)
