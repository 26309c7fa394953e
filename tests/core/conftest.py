"""Fixture that tests of the core share."""

import pytest

from tests.core.test_tick import Corridor
from tests.teacher.helpers import teach


@pytest.fixture
def driving() -> Corridor:
    """Return a robot without need of a teacher that has driven forward for two seconds, as taught at 100 counts."""
    corridor = Corridor()
    corridor.run(100, teach("forward", "first"))
    for _ in range(200):
        assert corridor.run(100).decision.action == "forward"
    return corridor
