"""Set points that bodies in the physics engine catch up with."""

import numpy as np

from simbridge.batch.contacts import SetPoints


def test_body_catches_up_with_each_set_point_once() -> None:
    points, none = SetPoints(), np.zeros((0, 2), dtype=np.int64)
    told = np.arange(12, dtype=np.int16).reshape(2, 3, 2)
    points.add(np.array([4, 7]), told, np.array([0, 2]), np.array([3, 3]))
    assert points.take(7, np.array([[12, 13]])).tolist() == [[10, 11], [12, 13]]
    points.add(np.array([7]), told[:1], np.array([0]), np.array([3]))
    assert points.take(7, none).tolist() == [[0, 1], [2, 3], [4, 5]]
    assert points.take(7, none).tolist() == []
    assert points.take(4, none).tolist() == [[0, 1], [2, 3], [4, 5]]
