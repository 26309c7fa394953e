"""Drawing of worlds."""

from matplotlib.figure import Figure

from simbridge.survey.drawing import draw_world
from tests.simbridge.rig import board, box, post, room


def test_drawing_of_a_world_has_each_wall() -> None:
    wall, block = board((1.0, 0.0), (1.0, 1.5), 0.1), box((2.6, 1.0), (3.1, 1.2), (2.7, 1.6))
    axes = Figure().add_subplot()
    draw_world(axes, room(walls=[wall], posts=[post(3.0, 3.0, 0.2)], boxes=[block]))
    assert len(axes.patches) == 1 + 3
    assert axes.get_aspect() == 1.0
