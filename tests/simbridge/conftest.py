"""Robots in an empty square room."""

from collections.abc import Iterator

import pytest

from tests.simbridge.rig import Rig, quiet_robot


@pytest.fixture
def rig() -> Iterator[Rig]:
    with Rig() as rig:
        yield rig


@pytest.fixture
def quiet_rig() -> Iterator[Rig]:
    with Rig(robot=quiet_robot()) as rig:
        yield rig
