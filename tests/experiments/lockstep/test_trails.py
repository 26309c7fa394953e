from kurt2rt.experiments.lockstep.trails import ways

TRAIL = [(0.0, 0.0), (0.1, 0.0), (0.2, 0.0), (2.0, 0.0), (2.1, 0.0)]


def test_a_robot_that_was_carried_leaves_a_gap() -> None:
    assert ways(TRAIL) == [TRAIL[:3], TRAIL[3:]]
    assert ways(TRAIL[:3]) == [TRAIL[:3]]
    assert ways([]) == []
