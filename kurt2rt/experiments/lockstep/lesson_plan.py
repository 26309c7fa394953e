"""Plan of a training run."""

from dataclasses import dataclass
from typing import Literal

from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import TaskSettings

Signs = Literal["none", "judge", "unknown", "chance"]
"""Source of the teacher's rewards: none, the task's judge, unknown situations, or random penalties."""

_CORRECTED_ONLY = (Phase.SUPERVISED, Phase.CORRECTIONS)
"""Phases without rewards and critic."""


@dataclass(frozen=True, slots=True)
class SignalTimes:
    """Intervals in s at which a scripted teacher rewards in phase 3 and appraises in phase 4."""

    bad_every_s: float = 1.0
    good_every_s: float = 2.0
    neutral_every_s: float = 1.0
    """Interval of neutral appraisals, for the critic only."""
    patience_s: float = 0.0
    """Time in s that something is bad before the teacher speaks of it; while teaching the critic, none."""
    gap_s: float = 0.0
    """Least time between two rewards or appraisals."""
    most_blame: int = 0
    """Most rewards of -1 in a phase; 0: no limit."""


@dataclass(frozen=True, slots=True)
class LessonPlan:
    """Plan of a training run: its phases with their times, and how often the teacher acts in them."""

    phases: tuple[tuple[Phase, float], ...]
    """Each with its time in s."""
    purpose: str = "lesson"
    """Another one begins at another place, with other noise."""
    signs: Signs = "none"
    times: SignalTimes = SignalTimes()
    blame_by_chance: int = 0
    """Number of random penalties."""
    reposition_every_s: float | None = None
    """The robot is set down at some start so often; 0: never; None: as the task says."""
    rescue_after_s: float | None = None
    """A robot that makes no way for so long is set down elsewhere by hand; None: as the task says."""
    set_down_every_s: float = 0.0
    """Interval in phase 4 of repositioning the robot in sight of something, also close to it; 0: never."""
    shown_s: float = 0.0
    """Then some action of the repertoire, whatever it leads to, drives it for so long."""
    shown_share: float = 1.0
    """So often of the times that it is set down."""
    rescues_who_asks: bool = False
    """True if the time of the stuck detector continues after a question."""
    clean_drive_s: float | None = None
    """The run ends sooner, after so long a drive in the last phase without press, question, touch or rescue; None: it
    lasts for all of its time."""
    most_presses: int | None = None
    """Number of presses after which the next one ends the run and teaches nothing; None: no limit."""

    @property
    def appraises(self) -> bool:
        """True if critic or teacher appraise situations: in phases 3 to 5, and with rewards."""
        return self.signs != "none" or any(phase not in _CORRECTED_ONLY for phase, _ in self.phases)

    @property
    def duration_s(self) -> float:
        """Duration of all phases in s."""
        return sum(lasts_s for _, lasts_s in self.phases)


def plan_of(task: TaskSettings) -> LessonPlan:
    """Return the plan of the task: phases 1 and 2, without phases of 0 s."""
    teaching = task.teaching
    corrections_s = teaching.duration_s - teaching.supervised_s
    phases = ((Phase.SUPERVISED, teaching.supervised_s), (Phase.CORRECTIONS, corrections_s))
    clean_drive_s = teaching.clean_drive_s if teaching.until_right else None
    return LessonPlan(tuple(each for each in phases if each[1]) or phases[:1], clean_drive_s=clean_drive_s)
