import math
import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Annotation

from kurt2rt.core.rla.rla import Origin, Phase, Rla
from kurt2rt.experiments.lockstep.drawing import draw_curriculum
from kurt2rt.experiments.lockstep.lesson import TrainingResult
from kurt2rt.experiments.lockstep.trails import draw_way
from kurt2rt.platform.tick_timer import TickTimer
from simbridge.contracts.simulation import Pose, Position
from tests.experiments.helpers import STAGE, short_task
from tests.experiments.rows import judged, lesson


@pytest.mark.parametrize(("worlds", "panels"), [((), 2), (("a", "b", "c"), 5)], ids=["lesson", "three exams"])
def test_the_picture_holds_the_lesson_its_growth_and_each_exam(
    worlds: tuple[str, ...], panels: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[Figure] = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: drawn.append(figure))
    exams = [judged(world=world, stuck=world == "b") for world in worlds]
    origin, trail = Origin("c", "Ann", Phase.SUPERVISED, 1), (Pose(0.5, 0.5, 0.0), Pose(0.6, 0.5, 0.0))
    result = TrainingResult(
        counts=lesson(1, rlas=20),
        rlas=tuple(Rla(number, (0.0,), "forward", None, origin) for number in range(1, 21)),
        growth=tuple(range(20)),
        trail=trail,
        ask_positions=(Position(0.6, 0.5),),
        collided_at=(),
        timer=TickTimer(),
    )
    draw_curriculum(result, exams, short_task(), STAGE, Path("never.png"))
    axes = [each for each in drawn[0].axes if each.axison]
    assert len(axes) == panels
    titles = [each.get_title() for each in axes]
    assert re.findall(r"\d+", titles[0]) == ["345", "20"]
    assert [(each.split(":")[0][-1], re.findall(r"[\d.]+", each)) for each in titles[2:]] == [
        (world.upper(), ["8.0", "0"]) for world in worlds
    ]
    assert ["failed" in each for each in titles[2:]] == [world == "b" for world in worlds]
    assert all(each.get_legend() for each in axes)


def test_a_drive_shows_both_ends_its_direction_and_its_marks() -> None:
    axes = Figure().subplots()
    there = [Pose(0.5 + 0.1 * step, 1.0, 0.0) for step in range(21)]
    carried = [Pose(0.5, 3.0 - 0.1 * step, -math.pi / 2) for step in range(11)]
    draw_way(axes, STAGE, "a", there + carried, [Position(1.5, 1.0)], [Position(2.4, 1.0), Position(2.5, 1.0)])
    marks = {str(line.get_label()): line for line in axes.lines}
    assert np.asarray(marks["asked (1)"].get_xdata()).tolist() == [1.5]
    assert np.asarray(marks["collided (2)"].get_xdata()).tolist() == [2.4, 2.5]
    assert np.max(np.asarray(marks["the robot"].get_ydata())) == 1.0  # it did not drive to where it was carried
    bodies = {
        str(patch.get_label()): np.asarray(patch.get_path().vertices) for patch in axes.patches if patch.get_label()
    }
    wide_m, high_m = np.ptp(bodies["start"], axis=0), np.ptp(bodies["end"], axis=0)
    assert wide_m == pytest.approx([0.44, 0.33], abs=0.02)
    assert high_m == pytest.approx([0.33, 0.44], abs=0.02)
    assert bodies["end"][:-1].mean(axis=0) == pytest.approx([0.5, 2.0])
    arrows = [(each.xyann, each.xy) for each in axes.texts if isinstance(each, Annotation)]
    along = [(round(head[0] - tail[0], 3), round(head[1] - tail[1], 3)) for tail, head in arrows]
    assert along == [(0.1, 0.0), (0.1, 0.0), (0.1, 0.0), (0.0, -0.1)]
