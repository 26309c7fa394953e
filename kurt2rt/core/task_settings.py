"""Schema of `config/tasks/*.yaml`."""

from collections.abc import Mapping
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Discriminator, Field, Tag, ValidationInfo, field_validator, model_validator

from behaviors.policies.policy import PolicySettings
from behaviors.registry import AnyJudgeSettings, AnyMetricSettings, AnyPolicySettings
from config.plugins import settings_from_elsewhere
from config.robot_plugins import plugin_task
from config.settings import Settings, SettingsError, load_settings
from config.settings_files import find_config
from kurt2rt.core.basic.doubt import DoubtSettings
from kurt2rt.core.critic.settings import CriticSettings
from kurt2rt.core.lesson_speed import SLOWEST
from kurt2rt.core.mid.settings import MidSettings
from kurt2rt.core.phase_settings import PhasesSettings
from kurt2rt.core.reinforcement.settings import ReinforcementSettings
from kurt2rt.core.settings_fields import Name, Sentence, Share, or_left_out
from kurt2rt.core.teacher_settings import QUICK_TEACHER, TeacherProfile, load_teacher

Seconds = Annotated[float, Field(ge=0, le=100_000)]
CriticName = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*(/[a-z][a-z0-9_]*)?$", max_length=128)]
AnyCritic = Annotated[
    Annotated[CriticName, Tag("name")] | Annotated[CriticSettings, Tag("settings")],
    Discriminator(lambda critic: "settings" if isinstance(critic, dict | CriticSettings) else "name"),
]
AnyMid = Annotated[
    Annotated[Name, Tag("name")] | Annotated[MidSettings, Tag("settings")],
    Discriminator(lambda mid: "settings" if isinstance(mid, dict | MidSettings) else "name"),
]

_LONGEST_UNTIL_RIGHT = 3
"""Longest time of a lesson until right, as a multiple of its time by the clock."""

Place = Literal["starts", "in_sight"]
"""Pose to set the robot down at: a start pose, or a random free one in sight of something near (a post, if there are
posts)."""


_NO_DOUBT = or_left_out("settings, or leave the key out for a robot without doubt")


def _each_once(names: tuple[str, ...]) -> tuple[str, ...]:
    if len(set(names)) < len(names):
        raise ValueError("each name may stand here once")
    return names


class FeatureWeight(Settings):
    """Weight of some features in every distance, recent and averaged; features not named have 1."""

    weight: Annotated[float, Field(ge=0, le=10)]
    features: Annotated[tuple[str, ...], Field(min_length=1)]
    """Names in the situation definition."""


class LearningSettings(Settings):
    """Settings by which the basic level matches situations to RLAs, asks, and places corrections."""

    radius: Annotated[float, Field(gt=0, le=100_000)]
    """Confidence radius R, in the units of the situation (counts)."""
    history_weight: Annotated[float, Field(ge=0, le=10)]
    """Weight of the averaged features in every distance, as a fraction of the recent ones' weight."""
    weights: tuple[FeatureWeight, ...] = ()
    """Weights other than 1."""
    insert_radius_fraction: Share
    """A correction farther than this share of R from the nearest condition inserts a new RLA, else it replaces."""
    ask_radius_fraction: Annotated[float, Field(gt=0, le=1)] = 1.0
    """Fraction of R beyond which the robot asks in phases 1 and 2, with a teacher there; otherwise it asks beyond R."""
    answers_override_holds: bool = False
    """Keep the action of an RLA that an answer or a press taught where a lesson of a hold would replace it."""
    skip_uncertain_lessons: bool = False
    """Let neighbours answer, without a teacher, instead of a lesson of a hold that differs from its five nearest
    neighbours of other presses."""
    mirrored: bool = False
    """Each RLA also answers in the mirror image of its situation, with the mirror image of its action."""
    widths: tuple[Annotated[float, Field(gt=0.5, lt=2)], ...] = ()
    """Factors: each RLA also answers where all that its lesson saw is that many times as far away."""
    minimum_action_s: Annotated[float, Field(ge=0, le=5)]
    teacher_delay_s: Annotated[float, Field(ge=0, le=2)] = 1.0
    """Time between a situation and a person's press about it, until four answers have shown the teacher's own."""
    doubt: Annotated[DoubtSettings | None, _NO_DOUBT] = None
    """Doubt, by which the robot asks also inside the radius; None: it asks only outside."""

    @model_validator(mode="after")
    def _averages_have_no_width(self) -> Self:
        if self.widths and self.history_weight:
            raise ValueError("widths need history_weight 0: averages cannot be rendered at another width")
        return self


class PaperDefaults(LearningSettings):
    """Plain reading of the paper: all 72 values weigh 1, corrections only replace, no action is held.

    Only the radius can be set; other values would make it another reading.
    """

    history_weight: Annotated[float, Field(ge=1, le=1)] = 1.0
    weights: Annotated[tuple[FeatureWeight, ...], Field(max_length=0)] = ()
    insert_radius_fraction: Annotated[float, Field(ge=1, le=1)] = 1.0
    ask_radius_fraction: Annotated[float, Field(ge=1, le=1)] = 1.0
    answers_override_holds: Literal[False] = False
    skip_uncertain_lessons: Literal[False] = False
    mirrored: Literal[False] = False
    widths: Annotated[tuple[float, ...], Field(max_length=0)] = ()
    minimum_action_s: Annotated[float, Field(ge=0, le=0)] = 0.0
    doubt: Annotated[None, _NO_DOUBT] = None


class TeacherSettings(Settings):
    """Speed and errors of the scripted teacher of a task, without the limits of a person."""

    reaction_s: Seconds
    """Time between the robot's question and the answer."""
    patience_s: Seconds
    """Time for which the robot acts unlike the policy before it is corrected."""
    error_rate: Share
    """Fraction of answers and corrections that name another action than the policy."""


class TeachingSettings(Settings):
    """Settings of a training run: world, length of phases 1 and 2, lesson speed and teacher."""

    world: str
    supervised_s: Seconds
    """Length of phase 1, in which the teacher only answers questions."""
    corrections_s: Seconds
    """Length of phase 2, in which the teacher corrects as well."""
    until_right: bool = False
    """End the lesson after a clean drive in phase 2, in place of by the clock; it then lasts at most three times as
    long."""
    clean_drive_s: Annotated[float, Field(gt=0, le=1000)] = 60.0
    """Length of that drive: without press, question, touch or rescue."""
    rescue_after_s: Annotated[float, Field(gt=0, le=1000)]
    """Time of driving at full speed without progress or question after which the robot is set down elsewhere."""
    lesson_speed: Annotated[float, Field(ge=SLOWEST, le=1)] = 1.0
    """Fraction of their speed at which actions drive while a teacher teaches them; a teacher can set another one."""
    reposition_every_s: Seconds = 0.0
    """Interval at which the robot is set down elsewhere; 0: never."""
    reposition_to: Place = "starts"
    teacher: TeacherSettings
    profile: TeacherProfile = QUICK_TEACHER
    """Teacher by name; its own limits count instead of `teacher` where it has some."""

    @property
    def duration_s(self) -> float:
        """Return the robot time of the whole training run, in s; the longest if it ends by itself."""
        return (self.supervised_s + self.corrections_s) * (_LONGEST_UNTIL_RIGHT if self.until_right else 1)

    @property
    def slow_rescue_after_s(self) -> float:
        """Return `rescue_after_s` at the lesson speed, at which the same way takes longer, in s."""
        return self.rescue_after_s / self.lesson_speed


class SuccessSettings(Settings):
    """Conditions for passing an exam, besides not getting stuck and no guard stop."""

    collisions_at_most: Annotated[int, Field(ge=0, le=1000)] = 0
    progress_share: Share = 0.8
    """Required progress as a fraction of the teacher's own policy's."""
    right_at_least: Share = 0.0
    """Required fraction of junctions that are left through the right side."""


class ExamSettings(Settings):
    """Worlds, duration and criteria of a task's exam, in which no teacher helps the robot."""

    worlds: Annotated[tuple[str, ...], Field(min_length=1)]
    start: Place = "starts"
    duration_s: Annotated[float, Field(ge=1, le=100_000)]
    stuck_after_s: Annotated[float, Field(gt=0, le=1000)]
    """Time without progress after which the robot counts as stuck and the exam ends."""
    stuck_within_m: Annotated[float, Field(gt=0, le=100)] = 1.0
    """A robot that stays within this distance makes no progress; in training runs as well."""
    success: SuccessSettings = SuccessSettings()


class PaperResult(Settings):
    """Numbers that the paper reports for this task (section VII), for comparison in tables."""

    rlas: int = 0
    """0 if the paper has no such task."""
    teaching_s: Seconds = 0.0
    """0 if the paper does not report it."""

    @property
    def rlas_text(self) -> str:
        """Return the number of RLAs for tables; a dash for a task that the paper does not have."""
        return str(self.rlas) if self.rlas else "-"

    @property
    def teacher_text(self) -> str:
        """Return the teacher for tables; a dash for a task that the paper does not have."""
        return "a person" if self.rlas else "-"

    @property
    def teaching_time_text(self) -> str:
        """Return the teaching time for tables, in whole seconds; a dash for a task that the paper does not have."""
        if not self.rlas:
            return "-"
        return f"{self.teaching_s:.0f}" if self.teaching_s else "not told"


class TaskSettings(Settings):
    """Schema of `config/tasks/*.yaml`: what is taught, with which features and actions, and how it is examined.

    `load_task` reads one, by name or path. Robot, studies and exams all build their levels from it.
    """

    name: Name
    """Name of the task, also in the names of its files."""
    description: Sentence = ""
    """Task in one sentence to its teacher, such as "Teach it to follow the wall on its left"; made from the name by
    default.
    """
    system: Name | None = None
    """Name of the RLA system, if several tasks share it. They have the same situation and behaviours and continue each
    other's knowledge. The task's name by default."""
    robot: str | None = None
    """Robot that it is for, by name or path; None: KURT2, or the robot whose plug-in has the task. A command line may
    name another one (`hal.robot_settings.robot_named`)."""
    situation: str
    repertoire: str
    behaviours: Annotated[tuple[Name, ...], Field(min_length=1, max_length=64), AfterValidator(_each_once)] = ("",)
    """Taught behaviours, each with its own RLAs; the first is active at the start. A single unnamed one by default."""
    mid: Annotated[
        AnyMid | None, or_left_out("a name or settings, or leave the key out where there is no mid level")
    ] = None
    """Mid level, which selects the behaviours: a name in `config/mid_levels`, or its settings; None: the teacher
    selects."""
    learning: LearningSettings
    paper_defaults: PaperDefaults
    """Settings instead of `learning` for the plain reading of the paper."""
    reinforcement: ReinforcementSettings = ReinforcementSettings()
    critic: AnyCritic = "basic"
    """Critic, which is taught in phase 4: a name in `config/critics`, or of a robot's plug-in, or its settings."""
    judge: Annotated[
        AnyJudgeSettings | None, or_left_out("its settings, or leave the key out where nothing is judged")
    ] = None
    """Judge by which the scripted teacher gives rewards; None: it gives none."""
    phases: Annotated[
        PhasesSettings | None,
        or_left_out("its settings, or leave the key out where phases 3 to 5 are not tried out"),
    ] = None
    """Settings of the study of phases 3 to 5; None: there is none."""
    policy: AnyPolicySettings
    metric: AnyMetricSettings
    teaching: TeachingSettings
    exam: ExamSettings
    paper: PaperResult = PaperResult()

    @property
    def sentence(self) -> str:
        """Return the task in one sentence to its teacher."""
        return self.description or f"Teach it the task {self.name.replace('_', ' ')}"

    @property
    def system_name(self) -> str:
        """Return the name of the RLA system that knowledge of this task belongs to."""
        return self.system or self.name

    @field_validator("mid")
    @classmethod
    def _commands_what_has_a_name(cls, mid: AnyMid | None, others: ValidationInfo) -> AnyMid | None:
        if others.data.get("behaviours") == ("",):
            raise ValueError("a mid level commands behaviours by their names; give the task's in `behaviours`")
        return mid

    @field_validator("policy")
    @classmethod
    def _knows_what_is_taught(cls, policy: PolicySettings, others: ValidationInfo) -> PolicySettings:
        known = policy.behaviours
        for each in others.data.get("behaviours", ()):
            if known is not None and each not in known:
                raise ValueError(f"{policy.kind} knows the behaviours {', '.join(known)}, and not {each!r}")
        return policy


def load_task(
    name_or_path: str, *, paper_defaults: bool = False, changes: Mapping[str, str] | None = None
) -> TaskSettings:
    """Load the settings of a shipped task by name, or of a file by path.

    Args:
        name_or_path: a name in `config/tasks`, or a path.
        paper_defaults: take these, the plain reading of the paper, instead of `learning`.
        changes: values by dotted key, as in config.settings.load_settings; none of `learning` with `paper_defaults`.

    Raises:
        config.settings.SettingsError: for a missing or invalid file, and for a change of `learning` with
            `paper_defaults`.
    """
    path = find_config("tasks", name_or_path)
    for key in changes or ():
        if paper_defaults and key.split(".")[0] == "learning":
            raise SettingsError(
                f"{key} changes nothing in the plain reading of the paper",
                where=path,
                do=f"give {key.replace('learning', 'paper_defaults', 1)}",
            )
    task = load_settings(path, TaskSettings, changes)
    return task.model_copy(update={"learning": task.paper_defaults}) if paper_defaults else task


def installed_task(named: str) -> str:
    """Return the name for `load_task` of a task that a file or another computer names.

    Only shipped and installed tasks are found: a path or `module:Name` would run the code of a stranger.

    Raises:
        config.settings.SettingsError: there is no such task, or it is invalid.
    """
    try:
        with settings_from_elsewhere():
            load_task(named)
    except SettingsError:
        of_robot = plugin_task(named)
        if of_robot is None:
            raise
        return of_robot
    return named


def taught_by_named(task: TaskSettings, name_or_path: str) -> TaskSettings:
    """Return a copy of the task that a teacher by name or path teaches.

    Raises:
        config.settings.SettingsError: for a missing or invalid file.
    """
    return taught_by(task, load_teacher(name_or_path))


def taught_by(task: TaskSettings, profile: TeacherProfile) -> TaskSettings:
    """Return a copy of the task with this scripted teacher, and with its wishes (`as_its_teacher_wants`)."""
    teaching = task.teaching.model_copy(update={"profile": profile})
    return as_its_teacher_wants(task.model_copy(update={"teaching": teaching}))


def as_its_teacher_wants(task: TaskSettings) -> TaskSettings:
    """Return a copy of the task that asks and drives lessons as its scripted teacher wants.

    A profile may set the fraction of R beyond which the robot asks, and the speed of lessons.
    """
    profile, learning, teaching = task.teaching.profile, task.learning, task.teaching
    if profile.ask_radius_fraction is not None:
        learning = learning.model_copy(update={"ask_radius_fraction": profile.ask_radius_fraction})
    if task.name in profile.lesson_speeds:
        teaching = teaching.model_copy(update={"lesson_speed": profile.lesson_speeds[task.name]})
    return task.model_copy(update={"learning": learning, "teaching": teaching})
