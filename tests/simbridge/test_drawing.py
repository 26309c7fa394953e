from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from hal.simulation import Pose
from simbridge.drawing import draw_marks, draw_robot, draw_trail, draw_world
from simbridge.obstacle_settings import PolygonObstacleSettings, RoundObstacleSettings, WallSettings
from tests.simbridge.rig import ROBOT, room


def test_a_picture_shows_walls_robot_trail_and_marks(tmp_path: Path) -> None:
    world = room(
        walls=[WallSettings(name="board", from_m=(1.0, 0.0), to_m=(1.0, 1.5), thickness_m=0.1)],
        posts=[RoundObstacleSettings(name="post", x_m=3.0, y_m=3.0, radius_m=0.2)],
        boxes=[PolygonObstacleSettings(name="box", corners=((2.6, 1.0), (3.1, 1.2), (2.7, 1.6)))],
    )
    figure = Figure(figsize=(4, 4), dpi=50)
    axes = figure.add_subplot()
    draw_world(axes, world)
    draw_robot(axes, Pose(2.0, 2.0, 0.5), ROBOT)
    draw_trail(axes, [(0.5, 0.5), (1.5, 2.0), (2.0, 2.0)])
    draw_marks(axes, [(1.5, 2.0)], "lesson")
    axes.legend()
    picture = tmp_path / "room.png"
    figure.savefig(picture)
    assert picture.stat().st_size > 2000
    assert axes.get_aspect() == 1.0
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x in m", "y in m")
    assert len(axes.patches) == 1 + 3 + 3
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["lesson"]  # type: ignore[union-attr]


def test_the_picture_is_to_scale() -> None:
    figure = Figure()
    axes = figure.add_subplot()
    draw_robot(axes, Pose(1.0, 1.0, 0.0), ROBOT)
    corners = np.asarray(axes.patches[0].get_path().vertices)
    assert np.ptp(corners[:, 0]) == pytest.approx(ROBOT.geometry.outline_length_m)
    assert np.ptp(corners[:, 1]) == pytest.approx(ROBOT.geometry.outline_width_m)
