"""Schema of `config/tasks/*.yaml`."""

from pathlib import Path
from typing import Annotated

from pydantic import AfterValidator, Field

from behaviors.policies.wall_following import WallFollowingSettings
from hal.settings import Settings, find_config, load_settings

Seconds = Annotated[float, Field(ge=0, le=100_000)]
Share = Annotated[float, Field(ge=0, le=1)]
Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=64)]


def _each_once(names: tuple[str, ...]) -> tuple[str, ...]:
    if len(set(names)) < len(names):
        raise ValueError("each name may stand here once")
    return names


class LearningSettings(Settings):
    """How the RLA system of this task matches and takes lessons."""

    radius: Annotated[float, Field(gt=0, le=100_000)]
    """Confidence radius R, in the units of the situation (counts)."""
    past_weight: Annotated[float, Field(ge=0, le=10)]
    """Weight of the averaged features in every distance; the recent ones weigh 1."""
    insert_beyond_share: Share
    """A correction farther than this share of R from the nearest condition inserts a new RLA, else it replaces."""
    minimum_action_s: Annotated[float, Field(ge=0, le=5)]


class TeacherSettings(Settings):
    """How the scripted teacher behaves."""

    reaction_s: Seconds
    """From the robot's question to the answer."""
    patience_s: Seconds
    """How long the robot must do something else than the teacher would before it is corrected."""
    error_rate: Share
    """Share of answers and corrections that name another action than the policy."""


class TeachingSettings(Settings):
    """The course of a lesson."""

    world: str
    supervised_s: Seconds
    """Phase 1: the teacher answers questions only."""
    corrections_s: Seconds
    """Phase 2, after it: the teacher corrects while the robot drives, and still answers."""
    rescue_after_s: Annotated[float, Field(gt=0, le=1000)]
    """A robot that makes no way for so long, without a question, is set down elsewhere by hand."""
    teacher: TeacherSettings

    @property
    def duration_s(self) -> float:
        """Robot time of the whole lesson."""
        return self.supervised_s + self.corrections_s


class ExamSettings(Settings):
    """The course of an exam, without a teacher."""

    worlds: Annotated[tuple[str, ...], Field(min_length=1)]
    duration_s: Annotated[float, Field(ge=1, le=100_000)]
    stuck_after_s: Annotated[float, Field(gt=0, le=1000)]
    """No way made for so long is stuck, and ends the exam."""
    laps_share: Share
    """Share of the teacher's own laps that counts as success."""


class PaperResult(Settings):
    """What the paper reports for this task (section VII)."""

    rlas: int
    teaching_s: float


class TaskSettings(Settings):
    """One task."""

    name: str
    situation: str
    repertoire: str
    behaviours: Annotated[tuple[Name, ...], Field(min_length=1), AfterValidator(_each_once)] = ("",)
    """What is taught, each with RLAs of its own; the first is wanted at the start. One without a name when absent."""
    learning: LearningSettings
    policy: WallFollowingSettings
    teaching: TeachingSettings
    exam: ExamSettings
    paper: PaperResult


def load_task(name_or_path: str) -> TaskSettings:
    """Settings of a shipped task by name, or of a file by path. Raises hal.settings.SettingsError."""
    return load_settings(Path(find_config("tasks", name_or_path)), TaskSettings)
