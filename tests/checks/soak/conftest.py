"""Simulated robot for soak tests."""

from collections.abc import Iterator

import pytest

from simbridge.faults.long_run_rig import LongRunRig
from tests.checks.soak.helpers import ROBOT


@pytest.fixture
def rig() -> Iterator[LongRunRig]:
    rig = LongRunRig(ROBOT, "a", seed=2)
    yield rig
    rig.close()
