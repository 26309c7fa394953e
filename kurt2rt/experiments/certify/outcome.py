"""Stored outcomes of a certificate."""

from hal.settings import Settings
from kurt2rt.experiments.study.provenance import Provenance


class RunOutcome(Settings):
    """Counts of one run; ticks are counted from 1."""

    number: int
    world: str
    broken: str = ""
    """Sensor that broke and the way in which, such as s15=low; empty: all worked."""
    ticks: int
    """Ticks until the end, or until the robot was stuck or stopped."""
    unknown_ticks: int
    """Ticks in which it stood in an unknown situation."""
    questions: int
    """Times that it began to stand there."""
    first_question: int
    """Tick of the first question; 0: none."""
    collisions: int
    first_collision: int
    """Tick of the first collision; 0: none."""
    stuck: bool
    """True if it stayed in place for too long without being stopped; this ends the run."""
    stopped: str = ""
    """Watch that stopped it until a teacher comes: for a broken sensor, or the guard's; empty without a stop."""
    travelled_m: float
    end: tuple[float, float, float]
    """Pose after the last tick: x, y in m, heading in rad."""

    @property
    def clean(self) -> bool:
        """True without a collision, a question, a stop and being stuck."""
        return not (self.collisions or self.questions or self.stopped or self.stuck)

    def differing(self, other: "RunOutcome") -> list[str]:
        """Return the names of the fields that differ."""
        return [name for name in type(self).model_fields if getattr(self, name) != getattr(other, name)]


class BlockOutcome(Settings):
    """Outcomes of the runs of one job, in order."""

    made_of: Provenance
    runs: tuple[RunOutcome, ...]
    on_bus: tuple[int, ...] = ()
    """Numbers of the runs that the CAN loop drove alone, such as those with a broken sensor."""


class WitnessOutcome(Settings):
    """Run that the batch and the CAN loop drove, with equal results."""

    made_of: Provenance
    run: RunOutcome
    compared: bool
    """False if the run left the batch, so that there was nothing to compare."""
