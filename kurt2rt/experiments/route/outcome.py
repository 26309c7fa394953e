"""Stored outcome of a job."""

from typing import Literal

from hal.settings import Settings
from kurt2rt.experiments.study.provenance import Provenance

Place = tuple[float, float]
"""x and y in m, to the millimetre."""

Layer = Literal["symbols", "mid", "basic"]
"""Layer that failed: `symbols`, noticed junctions differ from the real ones; `mid`, a wrong choice from right symbols;
`basic`, a right choice that was not driven."""

LAYERS: tuple[Layer, ...] = ("symbols", "mid", "basic")


class Wrong(Settings):
    """One junction at which the robot did not do what is right."""

    at_s: float
    leg: int
    """Index of the junction on the route, from 0."""
    layer: Layer
    x_m: float
    y_m: float


class RouteDrive(Settings):
    """One exam."""

    duration_s: float
    junctions: int
    right: int
    wrong: tuple[Wrong, ...]
    collisions: int
    stuck: bool
    alarm: str
    share_unknown: float
    way_m: float
    trail: tuple[Place, ...]
    collided_at: tuple[Place, ...]

    @property
    def without_error(self) -> bool:
        """True if every decision was right, without a collision, to the end."""
        return not self.wrong and not self.collisions and not self.stuck and not self.alarm


class RouteOutcome(Settings):
    """One robot, taught one route and examined on it."""

    made_of: Provenance | None
    """None: it was made for once, and is not kept."""
    seed: int
    route: tuple[Place, ...]
    """Its junctions, from the first decision on."""
    start: Place
    teaching_s: float
    mid_rlas: int
    basic_rlas: int
    mid_asks: int
    mid_corrections: int
    missed_junctions: int
    """Junctions that the mid level missed in training; the teacher commanded there."""
    asks: int
    corrections: int
    """Corrections of the basic level, as `asks`."""
    rescues: int
    knowledge_hash: str
    drive: RouteDrive


class BasicOutcome(Settings):
    """One robot that was taught the streets, and knows no route yet."""

    made_of: Provenance
    seed: int
    teaching_s: float
    rlas: int
    knowledge_hash: str
