"""Stored outcomes of the study of broken sensors."""

from hal.settings import Settings
from kurt2rt.experiments.lockstep.faulty_sensor import FaultKind
from kurt2rt.experiments.study.provenance import Provenance


class FaultDrive(Settings):
    """Drive of a taught robot with one fault, and of the policy with the same fault from the same start."""

    fault: FaultKind
    noticed: str
    """Sign by which the broken sensor was noticed; empty if it was not."""
    driven_s: float
    """Time of driving with the fault until the notice, or until the end, in s."""
    misled_s: float
    """Part of `driven_s` in which the sensor's reading was farther than MISLEADS_COUNTS from a working one's."""
    wrong: tuple[str, ...]
    """Working sensors that were named as broken."""
    asks: int
    """Questions about unknown situations; each ends with the robot set down at another start."""
    collisions_before: int
    """Collisions with the fault until the notice, all of them without one."""
    collisions_after: int
    """Collisions after Go, on which the neighbours' readings replace the sensor's."""
    after_s: float
    """Time after Go, in s."""
    policy_collisions: int
    """Collisions of the policy, which has no check of its sensors, in the same time with the fault."""
    policy_before: int
    """Collisions of the policy until the robot noticed the fault."""


class SensorOutcome(Settings):
    """One sensor of one robot with each fault."""

    made_of: Provenance
    seed: int
    world: str
    sensor: str
    drives: tuple[FaultDrive, ...]


class HealthyOutcome(Settings):
    """Drive of one robot whose sensors work."""

    made_of: Provenance
    seed: int
    world: str
    driver: str
    driven_s: float
    """Time in which the wheels were told to turn, in s."""
    named: tuple[str, ...]
    """Working sensors that were named as broken, each with the sign."""
    collisions: int
