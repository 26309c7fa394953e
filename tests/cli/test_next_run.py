"""Runs of the simulated robot, one after the other in one program."""

import json
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from pathlib import Path

import pytest

from hal.kurt2_settings import load_kurt2
from hal.robot import STANDSTILL
from kurt2rt.channel.protocol.requests import NextRunRequest, SpeedRequest
from kurt2rt.channel.protocol.simulation import EXAM, NO_EXAM, ExamStatus
from kurt2rt.channel.server.dependencies import TeacherNow
from kurt2rt.core.decision.standing import NEXT_RUN
from kurt2rt.core.outcome import CommandRefusedError, Field, Outcome, RefusalCode, ResultCode
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import load_task
from kurt2rt.core.teaching.commands import Take, Teach
from kurt2rt.knowledge.exchange.package import export_knowledge
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.loading import open_knowledge
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.platform.durable_files import write_durably
from kurt2rt.service.live_exam import verdict_file
from kurt2rt.service.simulated_runs import SimulatedRun, SimulatedRuns
from kurt2rt.teacher import TeacherClient
from simbridge.simulation import Kurt2SimulationFactory
from tests.channel.channel_fixture import ChannelFixture
from tests.cli.helpers import Running, running
from tests.knowledge.lessons import created
from tests.knowledge.reading import events_in
from tests.knowledge.refusals import refused
from tests.teacher.states_of import state_where

ROBOT, TASK = load_kurt2(), load_task("wall_following")
TEACHER = TeacherNow("phone", 2, "noon")


def names_in(folder: Path) -> list[str]:
    return [each.name for each in folder.iterdir()]


def runs_in(folder: Path, *, taught_by_script: bool = False) -> SimulatedRuns:
    first = SimulatedRun("a", TASK, "wall_following", folder / "walls.knowledge")
    return SimulatedRuns(ROBOT, first, Kurt2SimulationFactory(ROBOT).require_worlds, taught_by_script=taught_by_script)


async def test_next_run_in_phase_5_with_a_session_stands_until_go(tmp_path: Path) -> None:
    runs = runs_in(tmp_path)
    await runs.prepare("b", None, False, TeacherNow("ann", 5, "noon"))
    runs.advance()
    desk = ChannelFixture()
    school = desk.runtime.handler
    school.control.stop(NEXT_RUN)
    for command in runs.present.first_commands:
        desk.runtime.inbox.put(command)
    record = desk.run(10, counts=300)
    assert (school.phase, school.clock.session, school.authority.teacher) == (Phase.AUTONOMOUS, "noon", "ann")
    assert (school.stops.active, record.guard_result.wheel_speeds) == (NEXT_RUN, STANDSTILL)


@pytest.mark.parametrize(
    ("world", "task", "code"),
    [
        ("/etc/passwd", None, RefusalCode.NO_WORLD),
        ("rooms-1e3", None, RefusalCode.NO_WORLD),
        (None, "../eight", RefusalCode.NO_TASK),
    ],
)
async def test_next_run_with_unknown_world_or_task_is_refused(
    tmp_path: Path, world: str | None, task: str | None, code: RefusalCode
) -> None:
    runs = runs_in(tmp_path)
    with pytest.raises(CommandRefusedError) as caught:
        await runs.prepare(world, task, False, TEACHER)
    view = await runs.view()
    given: dict[str, Field] = {"world": world, "known": view.worlds}
    if code is RefusalCode.NO_TASK:
        given = {"task": task, "known": tuple(each.name for each in view.tasks)}
    assert caught.value.outcome == Outcome(code, given)
    assert runs.next is None


@pytest.mark.parametrize("fresh", [False, True])
async def test_next_run_with_a_file_that_has_a_writer_is_refused(tmp_path: Path, *, fresh: bool) -> None:
    runs = runs_in(tmp_path)
    with open_knowledge(tmp_path / "eight.knowledge", ROBOT, load_task("eight")), refused(KnowledgeCode.ANOTHER_WRITER):
        await runs.prepare(None, "eight", fresh, TEACHER)


async def test_next_run_under_a_scripted_teacher_is_refused(tmp_path: Path) -> None:
    runs = runs_in(tmp_path, taught_by_script=True)
    for begun in (runs.prepare("b", None, False, TEACHER), runs.load(b"", TEACHER)):
        with pytest.raises(CommandRefusedError) as caught:
            await begun
        assert caught.value.outcome == Outcome(RefusalCode.TAUGHT_BY_SCRIPT)


@pytest.fixture(scope="module")
def taught(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a knowledge file with one RLA."""
    path = tmp_path_factory.mktemp("taught") / "taught.knowledge"
    with open_knowledge(path, ROBOT, TASK) as journal:
        condition = (100.0,) * len(journal.binding.feature_names)
        rla = replace(created(1).rla, condition=condition)
        journal.append([JournalEntry(replace(created(1), rla=rla), "2026-11-22T10:00:00.000+00:00")])
    return path


@pytest.mark.parametrize("form", ["archive", "knowledge file"])
async def test_loaded_knowledge_replaces_the_file_and_keeps_a_copy(tmp_path: Path, taught: Path, form: str) -> None:
    runs = runs_in(tmp_path)
    open_knowledge(runs.present.knowledge, ROBOT, TASK).close()
    if form == "archive":
        export_knowledge(taught, tmp_path / "out.zip", ROBOT, TASK, stamp="2026-11-22T10:00:00.000+00:00")
    content = (tmp_path / "out.zip" if form == "archive" else taught).read_bytes()
    assert await runs.load(content, TEACHER) == Outcome.of(ResultCode.KNOWLEDGE_LOADED, lessons=1)
    assert runs.advance().endswith(f" {tmp_path / 'walls.knowledge.1'}")
    assert len(events_in(tmp_path / "walls.knowledge")) == 1
    assert not runs.present.fresh
    assert not [name for name in names_in(tmp_path) if name.startswith(".")]


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (b"PK\x03\x04 and no more", "the uploaded file: is damaged"),
        (b"a letter to my robot", "the uploaded file: "),
        (b"SQLite format 3\x00" + bytes(4000), "the uploaded file: "),
    ],
)
async def test_upload_that_is_no_knowledge_is_refused_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, content: bytes, why: str
) -> None:
    monkeypatch.chdir(tmp_path)
    runs = runs_in(Path())
    with pytest.raises(KnowledgeError, match=f"^{why}") as caught:
        await runs.load(content, TEACHER)
    assert "\n" not in str(caught.value)
    assert str(tmp_path) not in str(caught.value)
    assert runs.next is None
    assert names_in(tmp_path) == []


def unable(path: Path) -> Path:
    """Make a knowledge file that fits, with an action that no repertoire here has."""
    with open_knowledge(path, ROBOT, TASK) as journal:
        rla = replace(created(1, action="fly").rla, condition=(100.0,) * len(journal.binding.feature_names))
        journal.append([JournalEntry(replace(created(1), rla=rla), "2026-11-22T10:00:00.000+00:00")])
    return path


async def test_upload_with_an_unknown_action_is_refused(tmp_path: Path) -> None:
    content = unable(tmp_path / "given.knowledge").read_bytes()
    runs = runs_in(tmp_path)
    with pytest.raises(KnowledgeError, match=r"RLA 1 .*fly"):
        await runs.load(content, TEACHER)
    assert runs.next is None
    assert not [name for name in names_in(tmp_path) if name.startswith(".")]


async def test_present_file_under_another_tasks_name_is_set_aside(tmp_path: Path) -> None:
    first = SimulatedRun("a", TASK, "wall_following", tmp_path / "eight.knowledge")
    runs = SimulatedRuns(ROBOT, first, Kurt2SimulationFactory(ROBOT).require_worlds, taught_by_script=False)
    with open_knowledge(first.knowledge, ROBOT, TASK):
        with refused(KnowledgeCode.OTHER_TASK, taught="wall_following", wanted="eight"):
            await runs.prepare(None, "eight", False, TEACHER)
        assert runs.next is None
        assert (await runs.prepare(None, "eight", True, TEACHER)).fields["task"] == "eight"  # set aside, then
    runs.advance()
    assert (tmp_path / "eight.knowledge.1").exists()


@asynccontextmanager
async def teacher_of(robot: Running, folder: Path) -> AsyncIterator[TeacherClient]:
    port = int(robot.wait_for("UDP port").split()[-1])
    async with TeacherClient(folder / "var" / "devices" / "local", port=port) as client:
        assert (await client.send(Take)).accepted
        yield client


async def test_next_run_keeps_teacher_lessons_and_verdict(tmp_path: Path) -> None:
    knowledge = tmp_path / "var" / "wall_following.knowledge"
    knowledge.parent.mkdir()
    open_knowledge(knowledge, ROBOT, TASK).close()
    passed = ExamStatus(False, 1.0, "Passed in 3 of 3 worlds.")
    with running("run", "--port", "0", folder=tmp_path) as robot:
        async with teacher_of(robot, tmp_path) as client:
            asks = await state_where(client, cause="unknown", teacher="local")
            assert (await client.send(Teach, action="forward", decision_tick=asks.tick)).accepted
            first = await state_where(client, lessons=1, unsaved=0)
            kept_verdict = verdict_file(knowledge)
            assert kept_verdict is not None
            write_durably(kept_verdict, json.dumps(EXAM.plain_of(passed)))
            answer = await client.send(NextRunRequest, world="b", fresh=False, task=None)
            assert answer.accepted, answer.text
            moved = await state_where(client, lambda now: now.boot != first.boot, teacher="local", lessons=1)
            assert await client.exam() == passed
            answer = await client.send(NextRunRequest, world=None, fresh=True, task=None)
            assert answer.accepted, answer.text
            second = await state_where(client, lambda now: now.boot != moved.boot, teacher="local", lessons=0)
            assert await client.exam() == NO_EXAM, "of the new file"
            assert second.stopped == NEXT_RUN
            assert (second.left_m_s, second.right_m_s) == (0.0, 0.0)
            simulation, world = await client.simulation(), await client.world()
            assert simulation is not None
            assert world is not None
            assert (simulation.world, world.name, simulation.unit) == ("b", "B", "laps")
            saved = (knowledge.parent / "wall_following.knowledge.1").read_bytes()
            answer = await client.load(saved)
            assert answer.accepted, answer.text
            third = await state_where(
                client, lambda now: now.boot != second.boot, teacher="local", lessons=1, unsaved=0
            )
            assert (await client.send(SpeedRequest, times=3)).accepted
            # Ticks of robot time go on one by one, none is missed; and again at the speed of real time.
            faster = await state_where(client, lambda now: now.tick >= third.tick + 30)
            assert (await client.send(SpeedRequest, times=1)).accepted
            slower = await state_where(client, lambda now: now.tick >= faster.tick + 30)
            assert slower.boot == third.boot
        robot.wait_for(f"kept as {Path('var', 'wall_following.knowledge.1')}")
    for each in (knowledge, knowledge.with_name("wall_following.knowledge.1")):
        assert len(events_in(each)) == 1
    assert verdict_file(knowledge.with_name("wall_following.knowledge.1")) == kept_verdict
    assert len(names_in(tmp_path / "var" / "runs")) == 4
