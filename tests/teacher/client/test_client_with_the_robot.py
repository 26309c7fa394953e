"""The client against the robot's own program, with its journal and its channel, in real time."""

import hashlib
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import anyio
import pytest

from kurt2rt.channel.protocol.requests import PACKAGE, ExportRequest, SaveRequest
from kurt2rt.channel.security.pairing import LOCAL
from kurt2rt.core.outcome import Outcome, RefusalCode, ResultCode
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.teaching.commands import Correct, Take, Teach, Undo
from kurt2rt.knowledge.exchange.package import read_package
from kurt2rt.teacher import TeacherClient
from kurt2rt.teacher.client.answer import RefusedError
from tests.channel.lossy_link import LossyLink, Weather
from tests.channel.robot_at_work import SETTINGS, robot_at_work
from tests.teacher.states_of import state_where

A_BAD_LINK = Weather(loss=0.1, delay_s=0.005, jitter_s=0.005, doubled=0.05, overtaken=0.05)


@asynccontextmanager
async def taken_robot(folder: Path, weather: Weather) -> AsyncIterator[TeacherClient]:
    """Serve a robot behind a link in some weather; yield the client of its teacher."""
    async with (
        robot_at_work(folder) as at_work,
        LossyLink(at_work.port, up=weather, down=weather) as link,
        TeacherClient(at_work.pairing.device.folder, port=link.port) as robot,
    ):
        assert (await robot.send(Take)).accepted
        yield robot


async def test_a_lesson_over_a_bad_link_from_hello_to_undo(tmp_path: Path) -> None:
    async with taken_robot(tmp_path, A_BAD_LINK) as robot:
        hello = await robot.hello()
        assert (hello.robot, len(hello.sensors)) == (SETTINGS.name, 18)
        assert hello.phases == tuple(each.name.lower() for each in Phase)
        asks = await state_where(robot, teacher=LOCAL, cause="unknown")
        answer = await robot.send(Teach, action="forward", decision_tick=asks.tick)
        assert answer.accepted
        assert answer.outcome == Outcome.of(ResultCode.RLA_TAUGHT, rla=1, action="forward")
        drives = await state_where(robot, cause="rla", lessons=1, unsaved=0)
        assert (drives.rla, drives.action, drives.taught_by) == (1, "forward", LOCAL)
        (line,) = await robot.lessons()
        assert (line.teacher, line.phase, line.undone) == (LOCAL, 1, False)
        assert line.stamp != ""
        nonsense = await robot.send(Correct, action="fly")
        assert (nonsense.accepted, nonsense.why) == (False, "refused")
        assert nonsense.outcome is not None
        assert nonsense.outcome.code is RefusalCode.NO_ACTION
        agreed = await robot.send(Correct, action="forward", decision_tick=asks.tick)
        assert (agreed.accepted, agreed.lesson) == (True, None)
        assert answer.lesson == line.command_id
        assert (await robot.send(Undo, lesson=answer.lesson)).accepted
        await state_where(robot, lessons=0)
        (line,) = await robot.lessons()
        assert line.undone


@pytest.mark.deep  # a press ends, as it must, when this machine stalls for a quarter of a second
async def test_drive_by_hand_is_shown_taught_and_undone_as_one(tmp_path: Path) -> None:
    async with taken_robot(tmp_path, Weather()) as robot:
        await state_where(robot, teacher=LOCAL)
        async with robot.driving() as drive:
            assert drive.set((0.2, 0.2))
            await anyio.sleep(0.6)
        state = await state_where(robot, lambda state: state.shown is not None)
        assert state.shown is not None
        assert (state.shown.teacher, state.shown.actions) == (LOCAL, ("forward",))
        answer = await robot.teach_shown()
        assert answer.outcome is not None
        assert answer.outcome.code is ResultCode.DEMONSTRATION_TAUGHT
        lesson = answer.outcome.fields["lesson"]
        await state_where(robot, lambda state: state.lessons > 0, unsaved=0)
        assert [line.command_id for line in await robot.lessons()] == [lesson]
        assert (await robot.send(Undo, lesson=str(lesson))).accepted
        await state_where(robot, rlas=0)


async def test_copies_come_over_a_bad_link_whole(tmp_path: Path) -> None:
    async with taken_robot(tmp_path, A_BAD_LINK) as robot:
        asks = await state_where(robot, teacher=LOCAL, cause="unknown")
        assert (await robot.send(Teach, action="forward", decision_tick=asks.tick)).accepted
        for made, folder in (
            (await robot.send(SaveRequest, label="noon"), "saved"),
            (await robot.send(ExportRequest, form=PACKAGE), "exported"),
        ):
            assert made.accepted, made.text
            parts = [part async for part in robot.file_parts(made.extra["name"])]
            content = b"".join(part.content for part in parts)
            assert hashlib.sha256(content).hexdigest() == made.extra["sha256"]
            assert content == (tmp_path / folder / made.extra["name"]).read_bytes()
        with pytest.raises(RefusedError) as caught:
            await anext(robot.file_parts("knowledge.sqlite"))
        assert caught.value.answer is not None
        assert caught.value.answer.code is RefusalCode.NO_FILE
    given = read_package(tmp_path / "exported" / str(made.extra["name"]))
    assert len(given.lessons) == 1
