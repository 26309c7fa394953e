"""All figures of a study, as files with fixed names."""

from collections.abc import Iterator
from pathlib import Path

from hal.simulation import SimulationFactory
from kurt2rt.experiments.lockstep.report import label_of
from kurt2rt.experiments.paper.figures.drives import draw_drives, draw_eight
from kurt2rt.experiments.paper.figures.growth import draw_growth
from kurt2rt.experiments.paper.figures.worlds import draw_testing_ground, draw_worlds
from kurt2rt.experiments.paper.outcome import DriveOutcome
from kurt2rt.experiments.paper.study import PaperStudy
from kurt2rt.experiments.paper.summary import PaperSummary
from kurt2rt.experiments.study.figure import SavedFigure

_MOST_UNSEEN = 1
"""Generated worlds in the picture of a task."""


def draw_pictures(study: PaperStudy, stage: SimulationFactory, folder: Path) -> Iterator[SavedFigure]:
    """Draw each figure into the folder: fig2.png, fig4.png, fig6.png, fig7.png, drive-<task>.png.

    Those are left out whose task is not in the study.
    """
    paper = study.programme.paper
    shipped = study.of("shipped")
    if study.growth:
        path = folder / "fig2.png"
        planned = study.programme.growth[0]
        draw_growth(study.growth, planned.task.paper, path)
        robots = len({each.seed for each in study.growth[0].outcomes})
        yield SavedFigure(
            path,
            "Fig. 2: RLAs against teaching time for several R",
            f"{planned.task.name}, phase 1 only. Median (line) and quartiles (band) of {robots} robots for each R. The "
            "star is the only number in the paper's text, for both phases; the paper does not tell its R.",
        )
    path = folder / "fig4.png"
    draw_testing_ground(stage, paper.testing_ground, path)
    ground = f"World {label_of(paper.testing_ground)}, the testing ground, with the robot at a start pose, to scale."
    yield SavedFigure(path, "Fig. 4: the testing environment", ground)
    path = folder / "fig6.png"
    draw_worlds(stage, paper.worlds, path)
    yield SavedFigure(path, "Fig. 6: the test worlds", "World A is the one that is taught in.")
    for summary in shipped:
        outcome = summary.outcomes[0]
        if summary.settings.task == paper.eight:
            path = folder / "fig7.png"
            draw_eight(stage, outcome.drives[0], path)
            yield SavedFigure(
                path,
                "Fig. 7: the eight round two columns",
                f"The exam of the robot of seed {outcome.seed} without its teacher: {_told(outcome.drives[0])}. It is "
                "the first of the seeds, and was not chosen.",
            )
    for summary in shipped:
        outcome = summary.outcomes[0]
        path = folder / f"drive-{summary.task.name}.png"
        draw_drives(stage, _of_picture(summary), path)
        yield SavedFigure(
            path,
            summary.settings.title,
            f"Exams of the robot of seed {outcome.seed}, the first one, after {outcome.teaching_s:g} s of teaching, "
            f"with {outcome.rlas} RLAs.",
        )


def _of_picture(summary: PaperSummary) -> list[DriveOutcome]:
    drives = summary.outcomes[0].drives
    own = [each for each in drives if each.world in summary.task.exam.worlds]
    return own + [each for each in drives if each not in own][:_MOST_UNSEEN]


def _told(drive: DriveOutcome) -> str:
    return f"{drive.progress:.1f} {drive.unit} in {drive.duration_s:.0f} s, {drive.collisions} collisions"
