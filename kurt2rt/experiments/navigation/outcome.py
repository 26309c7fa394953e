"""Stored outcome of the navigation study."""

from typing import Literal

from hal.settings import Settings
from kurt2rt.experiments.study.provenance import Provenance

Place = tuple[float, float]
"""x and y in m, to the millimetre."""

Strategy = Literal["planning", "chance", "first taught"]
"""Strategy of the drive: a plan; as controls, random taught ways, or always the way taught first."""


class ErrandDone(Settings):
    """Outcome of one drive to a goal."""

    goal: str
    why_not: str
    """Empty where it came there."""
    seconds: float
    way_m: float
    shortest_m: float
    """Shortest distance from start to end; of a missed goal, to the middle of its street."""
    junctions: int
    """Number of junctions on the shortest way."""
    demonstrated: float | None
    """The shortest way that it was led there in one piece, as a multiple of the shortest one; None: never."""
    surprises: int
    """Number of places that differed from the plan."""
    collisions: int

    @property
    def reached(self) -> bool:
        """True if the robot reached the goal without a collision."""
        return not self.why_not and not self.collisions

    @property
    def detour(self) -> float:
        """Ratio of the travelled and the shortest distance, both in m."""
        return self.way_m / max(self.shortest_m, 0.1)


class ErrandsRun(Settings):
    """Outcome of all drives to goals by one strategy."""

    how: Strategy
    errands: tuple[ErrandDone, ...]
    trail: tuple[Place, ...]

    def good(self, detour_at_most: float) -> int:
        """Return the number of goals reached at this ratio of distances or less."""
        return sum(each.reached and each.detour <= detour_at_most for each in self.errands)

    @property
    def reached(self) -> tuple[ErrandDone, ...]:
        """Goals that were reached, however long the way."""
        return tuple(each for each in self.errands if each.reached)


class ErrandsOutcome(Settings):
    """Outcome of one robot: a tour and drives to goals."""

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
    """Position of each name: right of the middle of its street."""
    led: tuple[Place, ...]
    """Trail of the tour."""
    knowledge_hash: str
    runs: tuple[ErrandsRun, ...]
    """Runs by planning, and controls."""

    def run_of(self, how: Strategy) -> ErrandsRun | None:
        """Return the run of a strategy; None without one."""
        return next((each for each in self.runs if each.how == how), None)
