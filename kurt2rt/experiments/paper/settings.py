"""Schema of `config/paper/*.yaml`: the experiments, what is asked of them, and what the figures show; their extent."""

from dataclasses import dataclass
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from config.settings import Settings, SettingsError, load_settings
from config.settings_files import find_config
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.study.jobs import shortened_task
from simbridge.contracts.simulation import SimulationFactory

Share = Annotated[float, Field(gt=0, le=1)]
Count = Annotated[int, Field(ge=1, le=10_000)]


class AskedSettings(Settings):
    """Targets of one experiment of the paper study; a target that is left out is not checked."""

    rlas_at_most: Annotated[int, Field(ge=0, le=10_000)] = 0
    """The median of all robots; 0: not asked for."""
    success_at_least: dict[str, Share] = Field(default_factory=dict)
    """Share of the robots, by world."""
    right_at_least: Annotated[float, Field(ge=0, le=1)] = 0.0
    """Share of all junctions that are left as asked; 0: not asked for."""
    collisions_below_per_10_min: Annotated[float, Field(ge=0)] = 0.0
    """0: not asked for."""


class UnseenSettings(Settings):
    """Generated worlds that no robot was taught in; each robot is examined in some of them."""

    kind: Literal["rooms", "streets"]
    first: Annotated[int, Field(ge=0)]
    """Seed of the first one; the others follow."""
    count: Count
    success_at_least: Share

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the generated worlds."""
        return tuple(f"{self.kind}-{seed}" for seed in range(self.first, self.first + self.count))


class ExperimentSettings(Settings):
    """One task of the paper study, what its results have to reach, and the unseen worlds of its exams."""

    task: str
    """Name of the task, or path of its YAML file."""
    title: str
    asked: AskedSettings = AskedSettings()
    unseen: UnseenSettings | None = None
    paper_rlas_of: dict[str, Count] = Field(default_factory=dict)
    """RLAs that the paper reports for each taught behaviour, where there are several."""


class GrowthSettings(Settings):
    """Settings of Fig. 2: how the number of RLAs grows in phase 1, for several radii R in counts."""

    task: str
    radii: Annotated[tuple[Annotated[float, Field(gt=0, le=100_000)], ...], Field(min_length=1)]
    robots: Count
    """The first so many seeds."""
    duration_s: Annotated[float, Field(ge=1, le=100_000)]


class PaperSettings(Settings):
    """Schema of `config/paper`: tasks, worlds and numbers of the paper's figures."""

    experiments: Annotated[tuple[ExperimentSettings, ...], Field(min_length=1)]
    growth: GrowthSettings
    testing_ground: str
    """World of Fig. 4."""
    worlds: Annotated[tuple[str, ...], Field(min_length=1)]
    """Worlds of Fig. 6."""
    eight: str
    """Task of Fig. 7."""
    teacher: str = "ordinary"
    """Scripted teacher of all experiments: a name in `config/teachers`, or the path of a YAML file."""

    @model_validator(mode="after")
    def _each_task_once(self) -> Self:
        tasks = [each.task for each in self.experiments]
        twice = sorted({task for task in tasks if tasks.count(task) > 1})
        if twice:
            raise ValueError(f"{', '.join(twice)} stands twice; leave one out")
        return self


def load_paper(name_or_path: str = "basic_level", factory: SimulationFactory | None = None) -> PaperSettings:
    """Return the settings of a shipped study by name, or of a file by path.

    With a factory its worlds are checked, too. Raises config.settings.SettingsError that names file and key.
    """
    path = find_config("paper", name_or_path)
    paper = load_settings(path, PaperSettings)
    tasks = [each.task for each in paper.experiments]
    for key, task in (("growth.task", paper.growth.task), ("eight", paper.eight)):
        if task not in tasks:
            raise SettingsError(
                f"{key}: there is no experiment with task {task!r}", where=path, do=f"give one of: {', '.join(tasks)}"
            )
    if factory is None:
        return paper
    worlds = {"testing_ground": paper.testing_ground} | {f"worlds.{k}": each for k, each in enumerate(paper.worlds)}
    for key, world in worlds.items():
        try:
            factory.require_worlds(world)
        except SettingsError as error:
            raise SettingsError(f"{key}: {error}", where=path) from error
    return paper


@dataclass(frozen=True, slots=True)
class Extent:
    """Limits that make the paper study shorter, such as fewer worlds; settings of learning stay."""

    tasks: tuple[str, ...] | None = None
    """Tasks unless the user names others; None: all."""
    most_teaching_s: float | None = None
    most_exam_s: float | None = None
    most_unseen: int | None = None
    most_radii: int | None = None
    most_robots: int | None = None
    """Robots for each radius."""
    most_growth_s: float | None = None

    @property
    def is_whole(self) -> bool:
        """True if nothing is left out."""
        return self == WHOLE

    def task(self, task: TaskSettings) -> TaskSettings:
        """Return the task with less time."""
        return shortened_task(task, self.most_teaching_s, self.most_exam_s)

    def paper(self, paper: PaperSettings) -> PaperSettings:
        """Return the settings of the study with fewer generated worlds and less growth."""

        def least(value: float, most: float | None) -> float:
            return value if most is None else min(value, most)

        experiments = []
        for each in paper.experiments:
            unseen = each.unseen and each.unseen.model_copy(
                update={"count": least(each.unseen.count, self.most_unseen)}
            )
            experiments.append(each.model_copy(update={"unseen": unseen}))
        growth = paper.growth.model_copy(
            update={
                "radii": paper.growth.radii[-self.most_radii :] if self.most_radii else paper.growth.radii,
                "robots": least(paper.growth.robots, self.most_robots),
                "duration_s": least(paper.growth.duration_s, self.most_growth_s),
            }
        )
        return paper.model_copy(update={"experiments": tuple(experiments), "growth": growth})


WHOLE = Extent()
QUICK = Extent(
    tasks=("wall_following", "circle", "eight", "streets"),
    most_teaching_s=60.0,
    most_exam_s=20.0,
    most_unseen=2,
    most_radii=3,
    most_robots=2,
    most_growth_s=60.0,
)
"""Extent of a test of the program; its numbers say nothing about the paper."""
