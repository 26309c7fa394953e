"""Options of `kurt2rt train`, and the simulation that all its kinds of tasks share."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hal.robot_settings import RobotSettings
from kurt2rt.cli.options import (
    DEFAULT_TEACHER,
    Changes,
    PaperDefaults,
    RobotName,
    Seed,
    Teacher,
    parse_seeds,
    task_option,
)
from kurt2rt.cli.study_run import EngineOptions
from kurt2rt.core.task_settings import TaskSettings
from simbridge.contracts.simulation import SimulationFactory

DEFAULT_TASK = "wall_following"
FOLDER, ROUTES, ERRANDS = Path("results/train"), Path("results/route"), Path("results/errands")
"""Default folders of --out."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TrainOptions(EngineOptions):
    """Options of `kurt2rt train` as given on the command line."""

    task: Annotated[str | None, task_option(f"Default: the task of the file in --knowledge, else {DEFAULT_TASK}.")] = (
        None
    )
    teacher: Teacher = DEFAULT_TEACHER
    paper_defaults: PaperDefaults = False
    changes: Changes = None
    until_right: Annotated[
        bool,
        typer.Option(
            "--until-right",
            help="End each lesson after a clean drive: a minute without press, question, touch or rescue. "
            "It lasts at most three times as long as by the clock.",
        ),
    ] = False
    seed: Seed = 1
    knowledge: Annotated[
        Path | None,
        typer.Option(help="Knowledge file to teach into; goes on from what it holds. Default: a new one in --out."),
    ] = None
    seeds: Annotated[
        str | None,
        typer.Option(
            help="Teach and examine many robots, one per seed, e.g. 100-119; prints medians, quartiles and intervals."
        ),
    ] = None
    out: Annotated[
        Path | None,
        typer.Option(
            help=f"Folder for what is made; created when absent. Default: {FOLDER}, of routes {ROUTES}, of errands "
            f"{ERRANDS}.",
            show_default=False,
        ),
    ] = None
    robot_settings: RobotName = None
    decisions: Annotated[
        list[int] | None,
        typer.Option(
            help="Route only: number of junctions in its loop; with --seeds repeat for several. Default: the task's."
        ),
    ] = None
    basic: Annotated[
        Path | None,
        typer.Option(
            help="Route and errands only: knowledge of the streets, or a folder with one file per seed, as kurt2rt "
            "train --task streets leaves them. Without it the streets are taught first."
        ),
    ] = None

    @property
    def all_seeds(self) -> Sequence[int]:
        """Seeds of --seeds, or that of --seed. Raises typer.BadParameter."""
        return [self.seed] if self.seeds is None else parse_seeds(self.seeds)


@dataclass(frozen=True, slots=True)
class TrainSetup:
    """Simulation, robot and task of one call of `kurt2rt train`, made from its options."""

    factory: SimulationFactory
    robot: RobotSettings
    task: TaskSettings
    command: str
    """Typed words, as far as they decide the numbers."""
