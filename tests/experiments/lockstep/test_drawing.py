import re
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from kurt2rt.experiments.lockstep.drawing import draw_curriculum
from tests.experiments.helpers import STAGE, short_task
from tests.experiments.results import curriculum_result, exam_result


@pytest.mark.parametrize(("worlds", "panels"), [((), 2), (("a", "b", "c"), 5)], ids=["lesson", "three exams"])
def test_the_picture_holds_the_lesson_its_growth_and_each_exam(
    worlds: tuple[str, ...], panels: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[Figure] = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: drawn.append(figure))
    exams = [exam_result(world, stuck=world == "b") for world in worlds]
    draw_curriculum(curriculum_result(1, 20, *exams), short_task(), STAGE, Path("never.png"))
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
