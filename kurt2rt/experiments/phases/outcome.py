"""What the steps of one robot come to, as they are kept in their files."""

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
    """How often it was stuck."""
    alarm: str
    share_unknown: float
    action_changes_per_s: float
    findings: dict[str, float]
    succeeded: bool


class TeachingOutcome(Settings):
    """What was done in one step."""

    duration_s: float
    load: tuple[WorkloadMinute, ...]
    asks: int
    praise: int
    blame: int
    refused_signals: int
    collisions: int
    rescues: int
    unknown_rescues: int
    """Of these, those of a robot that did not know the situation, with nobody there to be asked."""
    alarms: int
    share_unknown: float
    agreement: tuple[float | None, ...]
    """After each ten seconds."""
    share_trusted: float
    withdrawn: int
    """Actions that had sunk and were asked for again."""
    critics_changes: int
    """Lessons that the critic gave itself."""
    rolled_back: int
    """Of its lessons, those that were undone since its score fell."""

    @property
    def interventions(self) -> int:
        """How often a person had to look after the robot: collided, stuck, without an answer, or stopped for good."""
        return self.collisions + self.rescues + self.alarms


class Judgement(Settings):
    """What the critic said of what a judge thinks, while nothing was taught."""

    judged: int
    """-1, 0 or +1: what the judge thinks."""
    said: int | None
    """What the critic says; None: it does not know."""
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
    """RLAs whose action was withdrawn and not taught anew: they ask, and exams pass over them."""
    judgements: tuple[Judgement, ...] = ()
    """Where the critic was only judged: each pair of opinions that came."""


class JobOutcome(Settings):
    """What one job leaves."""

    made_of: Provenance
    seed: int
    stages: tuple[StageOutcome, ...]
    teachers: tuple[ExamOutcome, ...] = ()
    """Drives of the teacher's own policy; of the first job alone."""
