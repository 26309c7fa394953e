from matplotlib.figure import Figure

from kurt2rt.experiments.lockstep.trails import draw_trail, ways

TRAIL = [(0.0, 0.0), (0.1, 0.0), (0.2, 0.0), (2.0, 0.0), (2.1, 0.0)]


def test_a_robot_that_was_carried_leaves_a_gap() -> None:
    assert ways(TRAIL, 0.2) == [TRAIL[:3], TRAIL[3:]]
    assert ways(TRAIL, 5.0) == [TRAIL]
    assert ways([], 0.2) == []


def test_the_pieces_of_one_trail_have_one_name() -> None:
    axes = Figure().subplots()
    draw_trail(axes, TRAIL, "the robot", carried_m=0.2)
    assert len(axes.lines) == 2
    assert list(axes.get_legend_handles_labels()[1]) == ["the robot"]
