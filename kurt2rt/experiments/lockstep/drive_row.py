"""Row of a drive without a teacher: exams return it, and all studies store it."""

from collections.abc import Iterable
from enum import StrEnum
from typing import Self

from pydantic import Field

from behaviors.metrics.task_metric import JUNCTIONS, RIGHT
from config.settings import Settings
from kurt2rt.core.task_settings import SuccessSettings
from simbridge.contracts.simulation import Pose, Position

Place = tuple[float, float]
"""x and y in m, to the millimetre."""
PLACES = ("trail", "asked_at", "collided_at")
"""Fields that are for pictures."""
NOT_JUDGED_BECAUSE = "not judged: the policy itself gets nowhere here"
"""Shown where there is room for the reason."""


class ExamVerdict(StrEnum):
    """Verdict on a drive without a teacher, by the drive of the task's policy from the same start.

    The robot passes with a share of the policy's progress and few collisions, neither stuck nor stopped
    (SuccessSettings).
    """

    PASSED = "passed"
    FAILED = "failed"
    NOT_JUDGED = "not_judged"
    """The reference drive makes too little progress to measure another drive by."""

    @property
    def text(self) -> str:
        """Text for tables and pictures."""
        return self.value.replace("_", " ")


class DriveRow(Settings):
    """Result of one drive without a teacher, as a study stores it."""

    world: str
    seed: int
    verdict: ExamVerdict = ExamVerdict.NOT_JUDGED
    """Verdict by the drive of the teacher's policy from the same start."""
    duration_s: float
    """Time until the end, or until the robot was stuck or stopped."""
    unit: str
    progress: float
    """Progress by the task's metric, in `unit`."""
    least_progress: float = 0.0
    """A drive that comes no farther gets nowhere, and no other drive is measured by it."""
    way_m: float
    collisions: int
    stuck: bool
    rescues: int = 0
    """Number of times the robot was stuck, if that does not end the drive."""
    alarm: str = ""
    """Latched stop of the guard, or stop for a broken sensor, which ends the drive; empty without one."""
    share_unknown: float
    """Ratio of ticks in unknown situations, 0 to 1."""
    questions: int = 0
    """Number of times the robot began to ask."""
    first_question_s: float = 0.0
    """Time of the first question; 0: none."""
    first_collision_s: float = 0.0
    """Time of the first collision; 0: none."""
    action_changes_per_s: float
    findings: dict[str, float] = Field(default_factory=dict)
    """Further measures of the task's metric, by name."""
    teacher: "DriveRow | None" = None
    """Drive of the teacher's policy; None where it is stored elsewhere."""
    trail: tuple[Pose, ...] = ()
    """Poses in m and rad, 0.2 s apart; it and the next two are empty if no picture is drawn."""
    asked_at: tuple[Place, ...] = ()
    collided_at: tuple[Place, ...] = ()

    @property
    def passed(self) -> bool:
        """True if the drive was judged and passed."""
        return self.verdict is ExamVerdict.PASSED

    @property
    def judged(self) -> bool:
        """True if the drive has a verdict, because the policy's own drive is a measure in this world."""
        return self.verdict is not ExamVerdict.NOT_JUDGED

    @property
    def failed(self) -> bool:
        """True if the drive collided, got stuck or was stopped by the guard for good."""
        return self.collisions > 0 or self.ended_early

    @property
    def ended_early(self) -> bool:
        """True if the robot was stuck, or stopped by the guard for good."""
        return self.stuck or self.rescues > 0 or bool(self.alarm)

    @property
    def early_end(self) -> str:
        """Why and when the drive ended before its time; empty if it did not."""
        why = self.alarm or ("stuck" if self.stuck else "")
        return f"{why} after {self.duration_s:.0f} s" if why else ""

    @property
    def got_nowhere(self) -> bool:
        """True if the progress is too small to measure another drive by."""
        return self.progress <= self.least_progress

    @property
    def junctions(self) -> int:
        """Number of junctions that the robot was asked at."""
        return round(self.findings.get(JUNCTIONS, 0.0))

    @property
    def right(self) -> int:
        """Number of junctions that were left as asked."""
        return round(self.findings.get(RIGHT, 0.0))

    @property
    def right_share(self) -> float:
        """Ratio of the junctions that were left as asked, 0 to 1; 0 without junctions."""
        return self.right / self.junctions if self.junctions else 0.0

    @property
    def why_no_measure(self) -> str:
        """Why this drive of a policy is no good measure: `failed` or `got nowhere`; empty if it is."""
        return "got nowhere" if self.got_nowhere else "failed" if self.failed else ""

    def judged_by(self, teachers_progress: float, success: SuccessSettings) -> Self:
        """Return the drive with its verdict, measured by the progress of the teacher's own policy from the same start.

        A drive passes with no more collisions than allowed, no alarm, not stuck, and with enough progress.
        `teachers_progress`: in the unit of `progress`, such as laps or m.
        """
        if teachers_progress <= self.least_progress:
            return self.with_verdict(ExamVerdict.NOT_JUDGED)
        enough = self.progress > 0.0 and self.progress >= success.progress_share * teachers_progress
        right = self.right_share >= success.right_at_least
        clean = self.collisions <= success.collisions_at_most and not self.stuck and not self.alarm
        return self.with_verdict(ExamVerdict.PASSED if clean and enough and right else ExamVerdict.FAILED)

    def counted(self) -> Self:
        """Return the drive without progress, findings and changes of action, which some studies do not read.

        A batch drives faster without them.
        """
        measures = {"progress": 0.0, "least_progress": 0.0, "unit": "", "action_changes_per_s": 0.0, "findings": {}}
        return self.model_copy(update=measures)

    def with_verdict(self, verdict: ExamVerdict) -> Self:
        """Return the drive with another verdict."""
        return self.model_copy(update={"verdict": verdict})

    def as_measure(self) -> Self:
        """Return the policy's own drive with its verdict: it passed unless it `failed`."""
        return self.with_verdict(ExamVerdict.FAILED if self.failed else ExamVerdict.PASSED)

    def stored(self, *, places: bool = False) -> Self:
        """Return the drive as it is stored: without `PLACES` of its teacher, and without its own unless `places`."""
        teacher = None if self.teacher is None else self.teacher.stored()
        return self.model_copy(update={**({} if places else dict.fromkeys(PLACES, ())), "teacher": teacher})


def label_of(world: str) -> str:
    """Return the label of a world in tables: a one-letter name as a capital, such as A; any other as it is."""
    return world.upper() if len(world) == 1 else world


def rounded_places(positions: Iterable[Position | Pose]) -> tuple[Place, ...]:
    """Return positions in m, rounded to the millimetre, as results store them."""
    return tuple((round(each.x_m, 3), round(each.y_m, 3)) for each in positions)


def rounded_poses(poses: Iterable[Pose]) -> tuple[Pose, ...]:
    """Return poses rounded to the millimetre and to 1/1000 rad, as results store them."""
    return tuple(Pose(*(round(each, 3) for each in pose)) for pose in poses)
