import re
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from kurt2rt.core.rla.rla import Origin, Phase, Rla
from kurt2rt.experiments.lockstep.drawing import draw_curriculum
from kurt2rt.experiments.lockstep.lesson import TrainingResult
from kurt2rt.platform.tick_timer import TickTimer
from simbridge.contracts.simulation import Position
from tests.experiments.helpers import STAGE, short_task
from tests.experiments.rows import judged, lesson


@pytest.mark.parametrize(("worlds", "panels"), [((), 2), (("a", "b", "c"), 5)], ids=["lesson", "three exams"])
def test_the_picture_holds_the_lesson_its_growth_and_each_exam(
    worlds: tuple[str, ...], panels: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[Figure] = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: drawn.append(figure))
    exams = [judged(world=world, stuck=world == "b") for world in worlds]
    origin, trail = Origin("c", "Ann", Phase.SUPERVISED, 1), (Position(0.5, 0.5), Position(0.6, 0.5))
    result = TrainingResult(
        counts=lesson(1, rlas=20),
        rlas=tuple(Rla(number, (0.0,), "forward", None, origin) for number in range(1, 21)),
        growth=tuple(range(20)),
        trail=trail,
        ask_positions=trail[1:],
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
    for each in axes:
        legend = each.get_legend()
        assert legend is not None
        assert each.lines
