"""teach_by_script: a real client, and a robot whose answers are the test's."""

from collections.abc import AsyncIterator
from pathlib import Path

import anyio
import pytest

from hal.robot_settings import load_robot
from kurt2rt.channel.protocol.requests import HelloRequest, PlaceRequest, StopRequest
from kurt2rt.channel.security.pairing import local_pairing
from kurt2rt.channel.server.reply import Reply, ReplyStatus, done, refusal
from kurt2rt.core.decision.standing import ActiveStop, StopReason
from kurt2rt.core.outcome import Outcome, RefusalCode
from kurt2rt.core.rla.rla import AUTO, Phase
from kurt2rt.core.task_settings import TaskSettings, load_task, taught_by
from kurt2rt.core.teacher_settings import QUICK_TEACHER
from kurt2rt.core.teaching.commands import BeginSession, Correct, EndSession, HoldAction, Pursue, Resume, SetPhase, Take
from kurt2rt.teacher import TeacherClient
from kurt2rt.teacher.client.answer import RefusedError
from kurt2rt.teacher.scripted.channel_teacher import teach_by_script
from simbridge.contracts.simulation import SimulatedPlace
from tests.patience import PATIENCE_S
from tests.teacher.client.test_client import INTRODUCED
from tests.teacher.stand_in_robot import Message, StandInRobot, in_a_task_of_its_own, stand_in_robot

SETTINGS = load_robot("kurt2")
_CarriedOut = Take | SetPhase | Pursue | BeginSession | EndSession | Resume


def short(name: str = "wall_following", each_phase_s: float = 0.1, corrections_s: float | None = None) -> TaskSettings:
    """Return a task whose phases 1 and 2 last `each_phase_s` each; `corrections_s`: phase 2 lasts longer."""
    task = load_task(name)
    both = {"supervised_s": each_phase_s, "corrections_s": corrections_s or each_phase_s}
    teaching = task.teaching.model_copy(update=both)
    return task.model_copy(update={"teaching": teaching})


class Mind:
    """Robot that carries out commands and loses the answers of the first `mute` of each type."""

    def __init__(self, robot: StandInRobot, *, simulated: bool = True, mute: int = 0) -> None:
        self._robot = robot
        self._simulated = simulated
        self._mute = mute
        self._silent: dict[type[Message], set[str]] = {}
        self._done: set[str] = set()
        self.hello: dict[str, object] = {}
        """Changes to its introduction."""
        self.stop_at_phase: Phase | None = None
        self.refuses_phase: Phase | None = None
        self._stopped_tick = -1

    async def __call__(self, request: Message) -> Reply:
        if isinstance(request, HelloRequest):
            return Reply(
                ReplyStatus.DONE, {**INTRODUCED.body, "behaviours": [""], "simulated": self._simulated, **self.hello}
            )
        if not isinstance(request, _CarriedOut):
            return done(self._robot.state.tick)
        reply = done(self._robot.state.tick)
        if request.command_id not in self._done:
            self._done.add(request.command_id)
            reply = self._carry_out(request)
        lost = self._silent.setdefault(type(request), set())
        if len(lost) < self._mute:
            lost.add(request.command_id)
        if request.command_id in lost:
            await anyio.sleep_forever()
        return reply

    def stop(self) -> None:
        """Stop as teacher anna."""
        self._stopped_tick = self._robot.show(stopped=ActiveStop(StopReason.SAID_STOP, "anna")).tick

    def _carry_out(self, request: _CarriedOut) -> Reply:
        robot = self._robot
        tick = robot.state.tick
        match request:
            case Take():
                robot.show(teacher="auto")
            case SetPhase(phase=phase) if phase is self.refuses_phase:
                return refusal("refused", Outcome(RefusalCode.TOO_MANY), tick)
            case SetPhase(phase=phase):
                robot.show(phase=int(phase))
                if phase is self.stop_at_phase:
                    self.stop()
            case Pursue(behaviour=behaviour):
                robot.show(behaviour=behaviour)
            case EndSession():
                robot.show(session=None, stopped=ActiveStop(StopReason.SESSION_OVER, robot.state.session or ""))
            case BeginSession(name=name) if robot.state.session is not None:
                return refusal("refused", Outcome.of(RefusalCode.SESSION_ON, session=name), tick)
            case BeginSession(name=name):
                robot.show(session=name, stopped=None)
            case Resume(seen_tick=int(seen)) if seen < self._stopped_tick:
                return refusal("stopped", Outcome(RefusalCode.STOPPED_SINCE), tick)
            case Resume():
                robot.show(stopped=None)
        return done(robot.state.tick)


@pytest.fixture
async def robot(tmp_path: Path) -> AsyncIterator[StandInRobot]:
    local_pairing(tmp_path / "teachers", tmp_path / "devices", AUTO)
    async with in_a_task_of_its_own(stand_in_robot(tmp_path / "teachers")) as robot:
        robot.show(session=None, phase=1, cause="stopped")
        yield robot


@pytest.fixture
async def client(robot: StandInRobot, tmp_path: Path) -> AsyncIterator[TeacherClient]:
    folder = tmp_path / "devices" / AUTO
    async with in_a_task_of_its_own(TeacherClient(folder, port=robot.port, patience_s=10.0)) as client:
        yield client


async def lesson(
    client: TeacherClient, robot: StandInRobot, ends_with: str, task: TaskSettings | None = None
) -> list[str]:
    """Teach until a line with `ends_with` comes, then let another teacher take the robot; return all lines."""
    said: list[str] = []

    def say(text: str) -> None:
        said.append(text)
        if ends_with in text:
            over.set()

    over = anyio.Event()
    with anyio.fail_after(PATIENCE_S):
        async with anyio.create_task_group() as tasks:

            async def teach() -> None:
                await teach_by_script(client, SETTINGS, task or short(), say)
                tasks.cancel_scope.cancel()

            tasks.start_soon(teach)
            await over.wait()
            if ends_with == ALONE:
                await robot.hears(Resume)
                async for state in client.states():
                    if state.stopped is None:
                        break
            robot.show(teacher="anna")
            await anyio.sleep_forever()
    return said


ALONE = "(phase 5)"
STAYS = "the robot stays"


async def test_teach_by_script_task_with_a_mid_level_is_refused(robot: StandInRobot, client: TeacherClient) -> None:
    with pytest.raises(RefusedError, match=r"\broute\b.* kurt2rt train --task route"):
        await teach_by_script(client, load_robot(), load_task("route"), print)
    assert robot.state.teacher != AUTO


STREETS = load_task("streets")
TURNS = list(STREETS.behaviours)


def streets(robot: StandInRobot, period_s: float, **shown: object) -> "Mind":
    """Start the robot for the streets, with long ticks so that 30 s are soon over."""
    robot.mind = mind = Mind(robot)
    mind.hello = {"task": "streets", "behaviours": TURNS, "period_s": period_s}
    robot.show(behaviour="straight_on", **shown)
    return mind


async def show_when_seen(robot: StandInRobot, client: TeacherClient) -> None:
    """Show a picture as soon as the client has the one before: on a slow machine the teacher misses none."""
    robot.showing = False
    while True:
        if client.state is None or client.state.tick == robot.state.tick:
            robot.show()
        await anyio.sleep(0.005)


async def test_teach_by_script_selects_each_behaviour_in_turn(robot: StandInRobot, client: TeacherClient) -> None:
    streets(robot, 0.2)
    said: list[str] = []
    with anyio.fail_after(PATIENCE_S):
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(show_when_seen, robot, client)
            tasks.start_soon(teach_by_script, client, SETTINGS, short("streets", 20.0), said.append)
            heard = await robot.hears(Pursue)
            while len({each.behaviour for each in heard}) < len(TURNS):
                heard = await robot.hears(Pursue, len(heard) + 1)
            tasks.cancel_scope.cancel()
    wanted = [each.behaviour for each in robot.all_of(Pursue)]
    assert list(dict.fromkeys(wanted)) == ["turn_left", "turn_right", "straight_on"]
    assert said[0].startswith("straight_on, turn_left, turn_right: ")
    assert " 30 s, " in said[0]
    turns = [f"{each}, for 30 s" for each in (*TURNS, TURNS[0])]
    alone = next(line for line in said if ALONE in line)
    assert [line for line in said if line in (*turns, alone)] == [*turns[:2], alone, *turns[2:]]


async def test_teach_by_script_without_progress_repositions_the_robot(
    robot: StandInRobot, client: TeacherClient
) -> None:
    streets(robot, 0.5, cause="rla", action="forward", rla=1, place=SimulatedPlace(1.0, 2.0, 0.5, 0.0, 0, 0))
    said: list[str] = []
    with anyio.fail_after(PATIENCE_S):
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(teach_by_script, client, SETTINGS, STREETS, said.append)
            (first, *_) = await robot.hears(PlaceRequest)
            while not said[-1].startswith("no progress"):
                await anyio.lowlevel.checkpoint()
            tasks.cancel_scope.cancel()
    assert (first.x_m, first.y_m, first.heading_rad) == (1.0, 2.0, 0.5)
    assert "15 s" in said[-1]


async def test_teach_by_script_person_s_stop_ends_commands(robot: StandInRobot, client: TeacherClient) -> None:
    mind = streets(robot, 0.5, cause="rla", action="forward", rla=1, place=SimulatedPlace(1.0, 2.0, 0.5, 0.0, 0, 0))
    said: list[str] = []
    with anyio.fail_after(PATIENCE_S):
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(teach_by_script, client, SETTINGS, STREETS, said.append)
            await robot.hears(SetPhase)
            mind.stop()
            stopped = robot.state.tick
            async for picture in client.states():
                if picture.tick > stopped + 100:  # 50 s later
                    break
            robot.show(teacher="anna")
    assert robot.all_of(Pursue) == []
    assert robot.all_of(PlaceRequest) == []
    assert robot.all_of(Resume) == []
    assert robot.state.stopped == ActiveStop(StopReason.SAID_STOP, "anna")
    assert said[-1].startswith("anna ")


async def test_teach_by_script_phase_5_guard_stop_is_resumed(robot: StandInRobot, client: TeacherClient) -> None:
    streets(robot, 0.5, cause="rla", action="forward", rla=1, place=SimulatedPlace(1.0, 2.0, 0.5, 0.0, 0, 0))
    with anyio.fail_after(PATIENCE_S):
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(teach_by_script, client, SETTINGS, short("streets", 1.0), lambda _: None)
            await robot.hears(Resume)
            robot.show(stopped=ActiveStop(StopReason.GUARD, "wheels disobey"))
            await robot.hears(Resume, 2)
            tasks.cancel_scope.cancel()


async def test_teach_by_script_holding_teacher_holds_and_lets_go(robot: StandInRobot, client: TeacherClient) -> None:
    robot.mind = Mind(robot)
    holding = QUICK_TEACHER.model_copy(update={"corrects_by": "hold", "hold_s": 0.2})
    task = taught_by(short(corrections_s=2.0), holding)
    with anyio.fail_after(PATIENCE_S):
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(teach_by_script, client, SETTINGS, task, lambda _: None)
            await robot.hears(SetPhase, 2)
            robot.show(cause="rla", action="back", rla=1)
            (held, *_) = await robot.hears(HoldAction)
            (released, *_) = await robot.hears(StopRequest)
            tasks.cancel_scope.cancel()
    assert held.action != "back"
    assert released.press_id == held.press_id


async def test_teach_by_script_rewinding_teacher_stops_and_resumes(robot: StandInRobot, client: TeacherClient) -> None:
    robot.mind = Mind(robot)
    task = taught_by(short(corrections_s=2.0), QUICK_TEACHER.model_copy(update={"corrects_by": "rewind"}))
    with anyio.fail_after(PATIENCE_S):
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(teach_by_script, client, SETTINGS, task, lambda _: None)
            await robot.hears(SetPhase, 2)
            wrong = robot.show(cause="rla", action="back", rla=1)
            (stop, *_) = await robot.hears(StopRequest)
            robot.show(cause="stopped", action=None, rla=None, stopped=ActiveStop(StopReason.SAID_STOP, "auto"))
            (correction, *_) = await robot.hears(Correct)
            await robot.hears(Resume)
            tasks.cancel_scope.cancel()
    assert stop.press_id is None
    assert correction.action != "back"
    assert correction.decision_tick == wrong.tick


async def test_teach_by_script_real_robot_is_refused(client: TeacherClient, robot: StandInRobot) -> None:
    robot.mind = Mind(robot, simulated=False)
    with pytest.raises(RefusedError, match="kurt2-indoor"):
        await teach_by_script(client, SETTINGS, short(), lambda _: None)
    assert {type(each) for each in robot.orders()} == {HelloRequest}


@pytest.mark.parametrize(
    ("hello", "robots"),
    [
        ({"task": "circle"}, "circle,"),
        ({"behaviours": ["there", "back"]}, r"wall_following \(behaviours: there, back\),"),
    ],
)
async def test_teach_by_script_robot_of_another_task_is_refused(
    client: TeacherClient, robot: StandInRobot, hello: dict[str, object], robots: str
) -> None:
    robot.mind = mind = Mind(robot)
    mind.hello = hello
    why = f"task {robots} .*wall_following.*--task "
    with pytest.raises(RefusedError, match=why + str(hello.get("task", "wall_following"))):
        await teach_by_script(client, SETTINGS, short(), lambda _: None)
    assert {type(each) for each in robot.orders()} == {HelloRequest}


async def test_teach_by_script_stop_at_phase_5_keeps_it_there(client: TeacherClient, robot: StandInRobot) -> None:
    robot.mind = mind = Mind(robot)
    mind.stop_at_phase = Phase.AUTONOMOUS
    said = await lesson(client, robot, STAYS)
    assert STAYS in said[-1]
    assert robot.state.stopped == ActiveStop(StopReason.SAID_STOP, "anna")
