"""Stored outcomes of the transfer study."""

from math import inf

from hal.settings import Settings
from kurt2rt.experiments.study.drive import Drive
from kurt2rt.experiments.study.provenance import Provenance


class Checkpoint(Settings):
    """Knowledge after a number of presses in the new world, and its exam there."""

    presses: int
    """Presses asked for; a robot that gave cause for fewer has all that it was taught."""
    teaching_s: float
    """Time of teaching up to the first press that does not count, or to the end."""
    lessons: int
    """Teaching events in the new world so far, undos included."""
    drive: Drive


class HomeOutcome(Settings):
    """Robot that was taught at home."""

    made_of: Provenance
    seed: int
    presses: int
    lessons: int
    """Teaching events at home."""
    rlas: int
    knowledge_hash: str
    drive: Drive
    """Exam at home."""
    policy: Drive
    """Policy's own drive there."""


class TransferOutcome(Settings):
    """Robot that was taught in a new world."""

    made_of: Provenance
    seed: int
    world: str
    presses: int
    """Presses in the new world."""
    asks: int
    corrections: int
    collisions: int
    """Collisions while it was taught there."""
    rescues: int
    teaching_s: float
    rlas: int
    """RLAs at the end, those of home included."""
    knowledge_hash: str
    checkpoints: tuple[Checkpoint, ...]
    """Checkpoints in ascending order of presses."""
    policy: Drive
    """Policy's own drive in the new world."""
    home_when_right: Drive
    """Exam at home with the knowledge of the first exam passed in the new world, or without one of the end."""
    home: Drive
    """Exam at home at the end."""

    @property
    def judged(self) -> bool:
        """True if the exams in the new world have verdicts."""
        return self.checkpoints[0].drive.judged

    @property
    def presses_until_right(self) -> float:
        """Smallest count of presses after which an exam in the new world was passed; infinite if none was."""
        return min((each.presses for each in self.checkpoints if each.drive.passed), default=inf)

    @property
    def seconds_until_right(self) -> float:
        """Time of teaching up to that exam's knowledge, in s; infinite if no exam was passed, 0 without a press."""
        passed = [each for each in self.checkpoints if each.drive.passed]
        if not passed:
            return inf
        return passed[0].teaching_s if passed[0].presses else 0.0
