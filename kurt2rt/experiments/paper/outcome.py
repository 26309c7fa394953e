"""Stored outcome of a job."""

from typing import Literal

from hal.settings import Settings
from kurt2rt.experiments.lockstep.exam_verdict import ExamVerdict
from kurt2rt.experiments.study.provenance import Provenance

Reading = Literal["shipped", "plain"]
"""Reading of the paper's scheme: the settings of this project, or the literal ones."""

Place = tuple[float, float]
"""x and y in m, to the millimetre."""


class DriveOutcome(Settings):
    """Outcome of one exam, with the teacher's own drive from the same start."""

    world: str
    unit: str
    progress: float
    teachers_progress: float
    teachers_collisions: int
    teachers_stuck: bool
    teachers_alarm: str
    succeeded: bool
    duration_s: float
    way_m: float
    collisions: int
    stuck: bool
    alarm: str
    share_unknown: float
    findings: dict[str, float]
    trail: tuple[Place, ...]
    asked_at: tuple[Place, ...]
    collided_at: tuple[Place, ...]
    least_progress: float = 0.0
    """A drive that comes no farther gets nowhere."""

    @property
    def verdict(self) -> ExamVerdict:
        """Verdict on the exam, by the teacher's own drive."""
        if self.teacher_got_nowhere:
            return ExamVerdict.NOT_JUDGED
        return ExamVerdict.PASSED if self.succeeded else ExamVerdict.FAILED

    @property
    def teacher_failed(self) -> bool:
        """True if the teacher's own drive collided, got stuck or was stopped by a latch."""
        return self.teachers_collisions > 0 or self.teachers_stuck or bool(self.teachers_alarm)

    @property
    def teacher_got_nowhere(self) -> bool:
        """True if the teacher's own drive made too little progress to measure another drive by."""
        return self.teachers_progress <= self.least_progress


class TaughtOutcome(Settings):
    """One robot, taught and examined."""

    made_of: Provenance
    seed: int
    teaching_s: float
    rlas: int
    rlas_of: dict[str, int]
    """Number of RLAs by behaviour; empty for a single behaviour."""
    knowledge_hash: str
    asks: int
    corrections: int
    rescues: int
    alarms: int
    drives: tuple[DriveOutcome, ...]


class GrowthOutcome(Settings):
    """One robot, taught in phase 1 only."""

    made_of: Provenance
    seed: int
    radius: float
    growth: tuple[int, ...]
    """Number of RLAs after each second."""
