"""Set points that bodies in the physics engine catch up with."""

import numpy as np

from simbridge.batch.contacts import SetPoints


def test_body_catches_up_with_each_set_point_once() -> None:
    points = SetPoints()
    told = np.arange(12, dtype=np.int16).reshape(2, 3, 2)
    points.add(np.array([4, 7]), told, np.array([0, 2]), np.array([3, 3]))
    assert points.take(7) == [(10, 11)]
    points.add(np.array([7]), told[:1], np.array([0]), np.array([3]))
    assert points.take(7) == [(0, 1), (2, 3), (4, 5)]
    assert points.take(7) == []
    assert points.take(4) == [(0, 1), (2, 3), (4, 5)]
