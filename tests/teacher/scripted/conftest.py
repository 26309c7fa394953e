from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from kurt2rt.channel.security.pairing import local_pairing
from kurt2rt.core.rla.rla import AUTO
from kurt2rt.teacher import TeacherClient
from tests.patience import PATIENCE_S
from tests.teacher.client.test_client import Clock
from tests.teacher.stand_in_robot import StandInRobot, in_a_task_of_its_own, stand_in_robot
from tests.teacher.states_of import state_where


@pytest.fixture
async def robot(tmp_path: Path) -> AsyncIterator[StandInRobot]:
    local_pairing(tmp_path / "teachers", tmp_path / "devices", AUTO)
    async with in_a_task_of_its_own(stand_in_robot(tmp_path / "teachers")) as robot:
        yield robot


@pytest.fixture
async def client(robot: StandInRobot, tmp_path: Path) -> AsyncIterator[TeacherClient]:
    """Return the client of the scripted teacher, which has seen the robot."""
    device = TeacherClient(tmp_path / "devices" / AUTO, port=robot.port, patience_s=PATIENCE_S, now=Clock())
    async with in_a_task_of_its_own(device) as client:
        await state_where(client)
        yield client
