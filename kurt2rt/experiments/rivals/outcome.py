"""Stored outcomes of a league."""

from hal.settings import Settings
from kurt2rt.experiments.study.provenance import Provenance
from kurt2rt.experiments.transfer.outcome import Drive


class PolicyOutcome(Settings):
    """Drives of the teacher's own policy, by which all rivals of a robot are judged."""

    made_of: Provenance
    seed: int
    drives: tuple[Drive, ...]
    """One in each world of the exam, in order."""


class RivalCheckpoint(Settings):
    """Exams with the knowledge after a number of presses."""

    presses: int
    """Presses asked for; a robot that gave cause for fewer has all that it was taught."""
    teaching_s: float
    """Time of teaching up to the first press that does not count, or to the end."""
    drives: tuple[Drive, ...]
    """One in each world in order, up to the first that failed."""

    @property
    def judged(self) -> bool:
        """True if a drive has a verdict."""
        return any(drive.judged for drive in self.drives)

    @property
    def passed(self) -> bool:
        """True if all drives with a verdict passed, and there is one."""
        return self.judged and all(drive.passed for drive in self.drives if drive.judged)


class RivalOutcome(Settings):
    """Lesson and exams of one robot with one rival. Times of the machine differ from run to run."""

    made_of: Provenance
    seed: int
    presses: int
    labels: int
    """Labels of the end: of a learner those that were not undone, of RLAs all lessons."""
    driven_s: float
    """Time in which the teacher drove the robot."""
    waited_s: float
    """Time in which the robot stood and asked."""
    asks: int
    corrections: int
    collisions: int
    """Collisions while it was taught."""
    alarms: int
    rescues: int
    teaching_s: float
    failure: str
    """Failure of the learner in the lesson or an exam; empty without one."""
    checkpoints: tuple[RivalCheckpoint, ...]
    """Checkpoints after the numbers of presses of the league, ascending; the last one is at the end of the lesson."""
    knowledge_bytes: int
    retraining_s: float
    """Processor time of all lessons, each with the first decision after it; 0 for RLAs of the robot's level."""
    longest_decision_ms: float
    """Processor time of the longest decision; 0 for RLAs of the robot's level."""
    tick_p99_us: float | None
    """99th percentile of the duration of a tick in the last minute of the lesson, with other work of the machine.

    None for a lesson in the batch, which has no ticks of the robot's program.
    """
    undo_s: float
    """Processor time of the undo of the last lesson, with a decision after it."""
    undo_restores: bool
    """True if that undo restores the decisions of before in the situations of all lessons."""
    change_ticks: tuple[int, ...]
    """Ticks from each correction of a robot that drove to the first tick of another action, or of none."""
    followed_share: float | None
    """Share of lessons after which the next decision is as told, in the situation of the lesson, 0 to 1.

    None without a lesson that names an action.
    """
