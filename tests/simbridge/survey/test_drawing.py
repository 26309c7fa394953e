"""Drawing of worlds and robots."""

from pathlib import Path

from matplotlib.figure import Figure

from simbridge.contracts.simulation import Pose
from simbridge.survey.drawing import draw_robot, draw_trail, draw_world
from tests.simbridge.rig import ROBOT, board, box, post, room


def test_drawing_of_a_world_with_a_robot_is_saved(tmp_path: Path) -> None:
    wall, block = board((1.0, 0.0), (1.0, 1.5), 0.1), box((2.6, 1.0), (3.1, 1.2), (2.7, 1.6))
    world = room(walls=[wall], posts=[post(3.0, 3.0, 0.2)], boxes=[block])
    figure = Figure(figsize=(4, 4), dpi=50)
    axes = figure.add_subplot()
    draw_world(axes, world)
    assert len(axes.patches) == 1 + 3
    draw_robot(axes, Pose(2.0, 2.0, 0.5), ROBOT)
    draw_trail(axes, [(0.5, 0.5), (1.5, 2.0), (2.0, 2.0)])
    figure.savefig(tmp_path / "room.png")
    assert (tmp_path / "room.png").stat().st_size > 2000
    assert axes.get_aspect() == 1.0
