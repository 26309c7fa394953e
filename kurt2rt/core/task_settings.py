"""Schema of `config/tasks/*.yaml`."""

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import AfterValidator, Discriminator, Field, Tag, ValidationInfo, field_validator

from behaviors.metrics.registry import AnyCourseSettings
from behaviors.policies.policy import PolicySettings
from behaviors.registry import AnyJudgeSettings, AnyPolicySettings
from hal.settings import Settings, SettingsError, find_config, load_settings
from kurt2rt.core.critic.settings import CriticSettings
from kurt2rt.core.mid.settings import MidSettings
from kurt2rt.core.phase_settings import PhasesSettings
from kurt2rt.core.reinforcement.settings import ReinforcementSettings

Seconds = Annotated[float, Field(ge=0, le=100_000)]
Share = Annotated[float, Field(ge=0, le=1)]
Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=64)]
AnyCritic = Annotated[
    Annotated[Name, Tag("name")] | Annotated[CriticSettings, Tag("settings")],
    Discriminator(lambda critic: "settings" if isinstance(critic, dict | CriticSettings) else "name"),
]
AnyMid = Annotated[
    Annotated[Name, Tag("name")] | Annotated[MidSettings, Tag("settings")],
    Discriminator(lambda mid: "settings" if isinstance(mid, dict | MidSettings) else "name"),
]
Sentence = Annotated[str, Field(pattern=r"^[^\x00-\x1f\x7f]+$", max_length=120)]

Place = Literal["starts", "in_sight"]
"""Where a hand sets the robot down: at a start pose, or anywhere free from where it sees something near (a post, where
there are posts)."""


def _each_once(names: tuple[str, ...]) -> tuple[str, ...]:
    if len(set(names)) < len(names):
        raise ValueError("each name may stand here once")
    return names


class FeatureWeight(Settings):
    """How much some features count in every distance, recent and averaged ones."""

    weight: Annotated[float, Field(ge=0, le=10)]
    features: Annotated[tuple[str, ...], Field(min_length=1)]
    """By their names in the situation definition."""


class LearningSettings(Settings):
    """How the RLA system of this task matches and takes lessons."""

    radius: Annotated[float, Field(gt=0, le=100_000)]
    """Confidence radius R, in the units of the situation (counts)."""
    past_weight: Annotated[float, Field(ge=0, le=10)]
    """What the averaged features weigh in every distance, as a share of what the recent ones do."""
    weights: tuple[FeatureWeight, ...] = ()
    """Features that do not weigh 1."""
    insert_beyond_share: Share
    """A correction farther than this share of R from the nearest condition inserts a new RLA, else it replaces."""
    minimum_action_s: Annotated[float, Field(ge=0, le=5)]


class PlainSettings(LearningSettings):
    """The plain reading of the paper: all 72 values weigh 1, corrections only replace, no action is held.

    Only the radius is free; with other values than these it would be another reading.
    """

    past_weight: Annotated[float, Field(ge=1, le=1)] = 1.0
    weights: Annotated[tuple[FeatureWeight, ...], Field(max_length=0)] = ()
    insert_beyond_share: Annotated[float, Field(ge=1, le=1)] = 1.0
    minimum_action_s: Annotated[float, Field(ge=0, le=0)] = 0.0


class TeacherSettings(Settings):
    """How the scripted teacher behaves."""

    reaction_s: Seconds
    """From the robot's question to the answer."""
    patience_s: Seconds
    """How long the robot must do something else than the teacher would before it is corrected."""
    error_rate: Share
    """Share of answers and corrections that name another action than the policy."""
    delete_after: Annotated[int, Field(ge=0, le=1000)] = 0
    """An RLA whose action was replaced so many times is deleted the next time it would be again; 0: never."""


class TeachingSettings(Settings):
    """The course of a lesson."""

    world: str
    supervised_s: Seconds
    """Phase 1: the teacher answers questions only."""
    corrections_s: Seconds
    """Phase 2, after it: the teacher corrects while the robot drives, and still answers."""
    rescue_after_s: Annotated[float, Field(gt=0, le=1000)]
    """A robot that makes no way for so long, without a question, is set down elsewhere by hand."""
    reposition_every_s: Seconds = 0.0
    """After each such time the robot is set down elsewhere, whatever it does; 0: never."""
    reposition_to: Place = "starts"
    teacher: TeacherSettings

    @property
    def duration_s(self) -> float:
        """Robot time of the whole lesson."""
        return self.supervised_s + self.corrections_s


class SuccessSettings(Settings):
    """What counts as success, besides not to be stuck and not to be stopped by the guard."""

    collisions_at_most: Annotated[int, Field(ge=0, le=1000)] = 0
    progress_share: Share = 0.8
    """Share of the progress that the teacher's own policy makes."""
    right_at_least: Share = 0.0
    """Share of the junctions that are left through the side that was asked for."""


class ExamSettings(Settings):
    """The course of an exam, without a teacher."""

    worlds: Annotated[tuple[str, ...], Field(min_length=1)]
    start: Place = "starts"
    duration_s: Annotated[float, Field(ge=1, le=100_000)]
    stuck_after_s: Annotated[float, Field(gt=0, le=1000)]
    """No way made for so long is stuck, and ends the exam."""
    stuck_within_m: Annotated[float, Field(gt=0, le=100)] = 1.0
    """No way is made by a robot that stays within this distance; in lessons, too."""
    success: SuccessSettings = SuccessSettings()


class PaperResult(Settings):
    """What the paper reports for this task (section VII)."""

    rlas: int
    teaching_s: Seconds = 0.0
    """0: the paper does not say it."""

    @property
    def teaching_time_text(self) -> str:
        """The teaching time as it is shown, in whole seconds."""
        return f"{self.teaching_s:.0f}" if self.teaching_s else "not told"


class TaskSettings(Settings):
    """One task."""

    name: Name
    """Files that hold what was taught and found are called after it."""
    what: Sentence | None = None
    """The task in one sentence to its teacher, such as "Teach it to follow the wall on its left". Default: made from
    the name.
    """
    system: Name | None = None
    """The RLA system that is taught, where it is not only this task's: tasks that name the same one have the same
    situation and behaviours, and go on in each other's knowledge. Named as the task when absent."""
    situation: str
    repertoire: str
    behaviours: Annotated[tuple[Name, ...], Field(min_length=1, max_length=64), AfterValidator(_each_once)] = ("",)
    """What is taught, each with RLAs of its own; the first is wanted at the start. One without a name when absent."""
    mid: AnyMid | None = None
    """The mid level, which says which of the behaviours is wanted: of `config/mid_levels` by name, or its settings;
    None: the teacher says it."""
    learning: LearningSettings
    plain: PlainSettings
    """What to take instead of `learning` for the plain reading of the paper."""
    reinforcement: ReinforcementSettings = ReinforcementSettings()
    critic: AnyCritic = "basic"
    """The internal critic, which is taught in phase 4: of `config/critics` by name, or its settings."""
    judge: AnyJudgeSettings | None = None
    """What the scripted teacher praises and blames; None: nothing."""
    phases: PhasesSettings | None = None
    """How phases 3 to 5 are tried out; None: not at all."""
    policy: AnyPolicySettings
    course: AnyCourseSettings
    teaching: TeachingSettings
    exam: ExamSettings
    paper: PaperResult

    @property
    def sentence(self) -> str:
        """The task in one sentence to its teacher."""
        return self.what or f"Teach it the task {self.name.replace('_', ' ')}"

    @property
    def system_name(self) -> str:
        """What knowledge of this task is bound to."""
        return self.system or self.name

    @field_validator("mid")
    @classmethod
    def _commands_what_has_a_name(cls, mid: AnyMid | None, others: ValidationInfo) -> AnyMid | None:
        if mid is None:
            raise ValueError("give a name or settings, or leave the key out where there is no mid level")
        if others.data.get("behaviours") == ("",):
            raise ValueError("a mid level commands behaviours by their names; give the task's in `behaviours`")
        return mid

    @field_validator("judge", mode="before")
    @classmethod
    def _named_or_left_out(cls, judge: object) -> object:
        if judge is None:
            raise ValueError("give its settings, or leave the key out where nothing is judged")
        return judge

    @field_validator("phases")
    @classmethod
    def _given_or_left_out(cls, phases: PhasesSettings | None) -> PhasesSettings | None:
        if phases is None:
            raise ValueError("give its settings, or leave the key out where phases 3 to 5 are not tried out")
        return phases

    @field_validator("policy")
    @classmethod
    def _knows_what_is_taught(cls, policy: PolicySettings, others: ValidationInfo) -> PolicySettings:
        known = policy.behaviours
        for each in others.data.get("behaviours", ()):
            if known is not None and each not in known:
                raise ValueError(f"{policy.kind} knows the behaviours {', '.join(known)}, and not {each!r}")
        return policy


def load_task(name_or_path: str, *, plain: bool = False, changes: Mapping[str, str] | None = None) -> TaskSettings:
    """Settings of a shipped task by name, or of a file by path; `plain`: for the plain reading of the paper.

    `changes` as in hal.settings.load_settings, and none of `learning` where `plain` stands for it.
    Raises hal.settings.SettingsError.
    """
    path = find_config("tasks", name_or_path)
    for key in changes or ():
        if plain and key.split(".")[0] == "learning":
            raise SettingsError(
                f"{key} changes nothing in the plain reading of the paper",
                where=path,
                do=f"give {key.replace('learning', 'plain', 1)}",
            )
    task = load_settings(path, TaskSettings, changes)
    return task.model_copy(update={"learning": task.plain}) if plain else task
