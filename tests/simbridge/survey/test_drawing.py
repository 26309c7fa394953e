"""Drawing of worlds and robots."""

from matplotlib.figure import Figure

from simbridge.contracts.simulation import Pose
from simbridge.survey.drawing import draw_robot, draw_world
from tests.simbridge.rig import ROBOT, board, box, post, room


def test_drawing_of_a_world_has_each_wall_and_the_robot() -> None:
    wall, block = board((1.0, 0.0), (1.0, 1.5), 0.1), box((2.6, 1.0), (3.1, 1.2), (2.7, 1.6))
    world = room(walls=[wall], posts=[post(3.0, 3.0, 0.2)], boxes=[block])
    axes = Figure().add_subplot()
    draw_world(axes, world)
    assert len(axes.patches) == 1 + 3
    draw_robot(axes, Pose(2.0, 2.0, 0.5), ROBOT)
    assert len(axes.patches) == 4 + 3
    assert axes.get_aspect() == 1.0
