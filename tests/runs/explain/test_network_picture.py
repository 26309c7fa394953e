"""Picture of the RLA network: tiles in groups of their action, each with what it senses and the way it takes."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from behaviors.action_groups import usual_speeds
from hal.robot_settings import load_robot
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.graph.graph import build_network
from kurt2rt.runs.explain.network_picture import draw_network
from kurt2rt.runs.explain.sensor_view import draw_motion
from tests.knowledge.graph.test_graph import DROVE, system

ROBOT, MOTIONS = load_robot(), usual_speeds("basic")


@pytest.mark.parametrize(("features", "fans"), [((), 0), (("s1", "s2"), 4)], ids=["without sensors", "sensors"])
def test_picture_has_groups_labels_and_a_fan_in_each_tile(features: Sequence[str], fans: int, tmp_path: Path) -> None:
    pictures = [tmp_path / f"{name}.svg" for name in ("first", "second")]
    for picture in pictures:
        draw_network(build_network(system(), DROVE, features=features), "the title", picture, ROBOT, MOTIONS)
    text, again = (picture.read_text(encoding="utf-8") for picture in pictures)
    assert text == again
    for shown in ("the title", "left: forward (2)", "right: forward (2)", ">90<", ">80<", ">4<", ">20x<"):
        assert shown in text, shown
    assert text.count('id="axes_') == 1 + fans
    assert ">10<" not in text  # from the one behaviour to the other a command led


def test_mid_level_tiles_are_where_their_places_are(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[Figure] = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: drawn.append(figure))
    network = build_network(system(), Statistics(), level="mid", features=("x_m", "y_m"))
    draw_network(network, "places", Path("never.png"), ROBOT, MOTIONS)
    five, six = (each.get_position() for each in drawn[0].axes[0].texts if each.get_text() in "56")
    assert six[0] - five[0] > 1.0
    assert six[1] == pytest.approx(five[1], abs=0.01)


@pytest.mark.parametrize(
    ("action", "aside", "ahead"),
    [("forward", 0, 1), ("back", 0, -1), ("curve_left", -1, 1), ("curve_right", 1, 1), ("spin_left", -1, -1)],
)
def test_arrow_of_an_action_leads_where_the_nose_goes(action: str, aside: int, ahead: int) -> None:
    axes = Figure().subplots()
    draw_motion(axes, ROBOT, MOTIONS[action], "#000000")
    way = np.asarray(axes.lines[0].get_xydata())
    begin, end = way[0], way[-1]
    assert begin == pytest.approx([0.0, ROBOT.geometry.outline_length_m / 2])
    assert [round(each, 2) and (1 if each > 0 else -1) for each in end - begin] == [aside, ahead]
