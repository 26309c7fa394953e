"""Stored outcomes of the steps of one robot."""

from hal.settings import Settings
from kurt2rt.experiments.lockstep.teacher_workload import WorkloadMinute
from kurt2rt.experiments.study.provenance import Provenance


class ExamOutcome(Settings):
    """One exam, or the drive of the teacher's own policy from the same start."""

    world: str
    unit: str
    progress: float
    duration_s: float
    way_m: float
    collisions: int
    rescues: int
    """Number of times the robot was stuck."""
    alarm: str
    share_unknown: float
    action_changes_per_s: float
    findings: dict[str, float]
    succeeded: bool


class TeachingOutcome(Settings):
    """Counters of the training run of one step."""

    duration_s: float
    load: tuple[WorkloadMinute, ...]
    asks: int
    praise: int
    blame: int
    refused_signals: int
    collisions: int
    rescues: int
    unknown_rescues: int
    """Rescues of a robot in an unknown situation without a teacher."""
    alarms: int
    share_unknown: float
    agreement: tuple[float | None, ...]
    """Agreement after each 10 s."""
    share_trusted: float
    withdrawn: int
    """Actions that were withdrawn because their value fell."""
    critics_changes: int
    """Lessons that the critic gave itself."""
    rolled_back: int
    """Lessons of the critic that were undone because its score fell."""

    @property
    def interventions(self) -> int:
        """Number of interventions by a person: after collisions, rescues and latched stops."""
        return self.collisions + self.rescues + self.alarms


class Judgement(Settings):
    """Opinions of judge and critic, with the number of their ticks."""

    judged: int
    """Opinion of the judge: -1, 0 or +1."""
    said: int | None
    """Opinion of the critic; None: unknown."""
    ticks: int


class StageOutcome(Settings):
    """A robot's knowledge at one stage, how it came there, and how it drives with it."""

    name: str
    rlas: int
    appraisals: int
    """RLAs of its critic."""
    knowledge_hash: str
    teaching: TeachingOutcome | None
    """None: nothing was taught since the stage before."""
    exams: tuple[ExamOutcome, ...]
    still_withdrawn: int = 0
    """RLAs with a withdrawn action: they ask, and exams skip them."""
    judgements: tuple[Judgement, ...] = ()
    """Pairs of opinions, if the critic was only judged."""


class JobOutcome(Settings):
    """Stored outcome of one job."""

    made_of: Provenance
    seed: int
    stages: tuple[StageOutcome, ...]
    teachers: tuple[ExamOutcome, ...] = ()
    """Drives of the teacher's own policy; of the first job alone."""
