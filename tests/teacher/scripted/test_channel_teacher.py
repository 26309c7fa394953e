"""The scripted teacher over the channel: a real client, and a robot whose mind is the test's."""

from collections.abc import AsyncIterator
from pathlib import Path

import anyio
import pytest

from hal.robot_settings import load_robot
from hal.simulation import SimulatedPlace
from kurt2rt.channel.protocol.requests import (
    HelloRequest,
    PhaseRequest,
    PlaceRequest,
    PursueRequest,
    Request,
    ResumeRequest,
    SessionRequest,
    TakeRequest,
)
from kurt2rt.channel.security.pairing import local_pairing
from kurt2rt.channel.server.reply import Reply, Verdict, done, refusal
from kurt2rt.core.decision.active_stop import ActiveStop, StopReason
from kurt2rt.core.rla.outcome import Outcome, RefusalCode
from kurt2rt.core.rla.programs import AUTO
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.teacher import TeacherClient
from kurt2rt.teacher.client.answer import RefusedError
from kurt2rt.teacher.scripted.channel_teacher import picture_in, teach_by_script
from kurt2rt.teacher.scripted.teacher import TeacherView
from tests.channel.states import state
from tests.teacher.client.test_client import HELLO
from tests.teacher.stand_in_robot import StandInRobot, in_a_task_of_its_own, stand_in_robot

SETTINGS = load_robot("kurt2")
_CarriedOut = TakeRequest | PhaseRequest | PursueRequest | SessionRequest | ResumeRequest


def short(name: str = "wall_following", each_phase_s: float = 0.1) -> TaskSettings:
    """A task whose phases 1 and 2 last so long."""
    task = load_task(name)
    teaching = task.teaching.model_copy(update={"supervised_s": each_phase_s, "corrections_s": each_phase_s})
    return task.model_copy(update={"teaching": teaching})


class Mind:
    """Does what the scripted teacher says, as far as its pictures show it; deaf to the first answers it should give."""

    def __init__(self, robot: StandInRobot, *, simulated: bool = True, mute: int = 0) -> None:
        self._robot = robot
        self._simulated = simulated
        self._mute = mute
        self._silent: dict[type[Request], set[bytes]] = {}
        self._done: set[bytes] = set()
        self.hello: dict[str, object] = {}
        """What it says otherwise when it introduces itself."""
        self.stop_at_phase: Phase | None = None
        self.refuses_phase: Phase | None = None
        self._stopped_tick = -1

    async def __call__(self, request: Request) -> Reply:
        if isinstance(request, HelloRequest):
            return Reply(Verdict.DONE, {**HELLO, "behaviours": [""], "simulated": self._simulated, **self.hello})
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
        """Anna says stop."""
        self._stopped_tick = self._robot.show(stopped=ActiveStop(StopReason.SAID_STOP, "anna")).tick

    def _carry_out(self, request: _CarriedOut) -> Reply:
        robot = self._robot
        tick = robot.state.tick
        match request:
            case TakeRequest():
                robot.show(teacher="auto")
            case PhaseRequest(phase=phase) if phase is self.refuses_phase:
                return refusal("refused", Outcome(RefusalCode.TOO_MANY), tick)
            case PhaseRequest(phase=phase):
                robot.show(phase=int(phase))
                if phase is self.stop_at_phase:
                    self.stop()
            case PursueRequest(behaviour=behaviour):
                robot.show(behaviour=behaviour)
            case SessionRequest(name=None):
                robot.show(session=None, stopped=ActiveStop(StopReason.SESSION_OVER, robot.state.session or ""))
            case SessionRequest(name=name) if robot.state.session is not None:
                return refusal("refused", Outcome.of(RefusalCode.SESSION_ON, session=name), tick)
            case SessionRequest(name=name):
                robot.show(session=name, stopped=None)
            case ResumeRequest(seen=seen) if seen < self._stopped_tick:
                return refusal("stopped", Outcome(RefusalCode.STOPPED_SINCE), tick)
            case ResumeRequest():
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
    async with in_a_task_of_its_own(TeacherClient(folder, port=robot.port, patience_s=0.15)) as client:
        yield client


async def lesson(
    client: TeacherClient, robot: StandInRobot, ends_with: str, task: TaskSettings | None = None
) -> list[str]:
    """Let it teach until it has said its last; then somebody else takes the robot. What it said."""
    said: list[str] = []

    def say(text: str) -> None:
        said.append(text)
        if ends_with in text:
            over.set()

    over = anyio.Event()
    with anyio.fail_after(10.0):
        async with anyio.create_task_group() as tasks:

            async def teach() -> None:
                await teach_by_script(client, SETTINGS, task or short(), say)
                tasks.cancel_scope.cancel()

            tasks.start_soon(teach)
            await over.wait()
            if ends_with == ALONE:
                await robot.hears(ResumeRequest)
                async for state in client.states():
                    if state.stopped is None:
                        break
            robot.show(teacher="anna")
            await anyio.sleep_forever()
    return said


ALONE = "now the robot drives alone"


def phases(robot: StandInRobot) -> list[Phase]:
    return [each.phase for each in dict.fromkeys(robot.all_of(PhaseRequest))]


async def test_a_task_with_a_mid_level_is_not_taught_over_the_channel(
    robot: StandInRobot, client: TeacherClient
) -> None:
    with pytest.raises(RefusedError, match=r"task route has a mid level.* kurt2rt lesson --task route"):
        await teach_by_script(client, load_robot(), load_task("route"), print)
    assert robot.state.teacher != AUTO


STREETS = load_task("streets")
TURNS = list(STREETS.behaviours)


def streets(robot: StandInRobot, period_s: float, **shown: object) -> "Mind":
    """It was started for the streets; its ticks are long, so that half a minute is soon over."""
    robot.mind = mind = Mind(robot)
    mind.hello = {"task": "streets", "behaviours": TURNS, "period_s": period_s}
    robot.show(behaviour="straight_on", **shown)
    return mind


async def test_several_behaviours_are_wanted_in_turn_also_when_the_robot_drives_alone(
    robot: StandInRobot, client: TeacherClient
) -> None:
    streets(robot, 1.0)
    said: list[str] = []
    with anyio.fail_after(10.0):
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(teach_by_script, client, SETTINGS, short("streets", 20.0), said.append)
            heard = await robot.hears(PursueRequest)
            while len({each.behaviour for each in heard}) < len(TURNS):
                heard = await robot.hears(PursueRequest, len(heard) + 1)
            tasks.cancel_scope.cancel()
    wanted = [each.behaviour for each in robot.all_of(PursueRequest)]
    assert list(dict.fromkeys(wanted)) == ["turn_left", "turn_right", "straight_on"]
    assert said[0].startswith("straight_on, turn_left, turn_right: in turn, each for 30 s, for over the channel")
    turns = [f"{each}, for 30 s" for each in (*TURNS, TURNS[0])]
    alone = "now the robot drives alone (phase 5)"
    assert [line for line in said if line in (*turns, alone)] == [*turns[:2], alone, *turns[2:]]


async def test_a_robot_that_makes_no_way_is_set_down_elsewhere_and_that_is_said(
    robot: StandInRobot, client: TeacherClient
) -> None:
    streets(robot, 0.5, cause="rla", action="forward", rla=1, place=SimulatedPlace(1.0, 2.0, 0.5, 0.0, 0, 0))
    said: list[str] = []
    with anyio.fail_after(10.0):
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(teach_by_script, client, SETTINGS, STREETS, said.append)
            (first, *_) = await robot.hears(PlaceRequest)
            while not said[-1].startswith("no way made"):
                await anyio.lowlevel.checkpoint()
            tasks.cancel_scope.cancel()
    assert (first.x_m, first.y_m, first.heading_rad) == (1.0, 2.0, 0.5)
    assert said[-1].startswith("no way made for 15 s: the robot is to stand where it came through, x 1.00 m, y 2.00 m")


async def test_a_robot_that_a_person_stopped_is_neither_turned_nor_set_down_and_one_that_is_taken_is_left(
    robot: StandInRobot, client: TeacherClient
) -> None:
    mind = streets(robot, 0.5, cause="rla", action="forward", rla=1, place=SimulatedPlace(1.0, 2.0, 0.5, 0.0, 0, 0))
    said: list[str] = []
    with anyio.fail_after(10.0):
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(teach_by_script, client, SETTINGS, STREETS, said.append)
            await robot.hears(PhaseRequest)
            mind.stop()
            stopped = robot.state.tick
            async for picture in client.states():
                if picture.tick > stopped + 200:  # 100 s later
                    break
            robot.show(teacher="anna")
    assert robot.all_of(PursueRequest) == []
    assert robot.all_of(PlaceRequest) == []
    assert robot.all_of(ResumeRequest) == []
    assert robot.state.stopped == ActiveStop(StopReason.SAID_STOP, "anna")
    assert said[-1] == "anna took the robot; the scripted teacher stops here"


async def test_alone_too_a_robot_of_several_behaviours_is_told_to_go_on_where_its_guard_stopped_it(
    robot: StandInRobot, client: TeacherClient
) -> None:
    streets(robot, 0.5, cause="rla", action="forward", rla=1, place=SimulatedPlace(1.0, 2.0, 0.5, 0.0, 0, 0))
    with anyio.fail_after(10.0):
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(teach_by_script, client, SETTINGS, short("streets", 1.0), lambda _: None)
            await robot.hears(ResumeRequest)
            robot.show(stopped=ActiveStop(StopReason.GUARD, "wheels disobey"))
            await robot.hears(ResumeRequest, 2)
            tasks.cancel_scope.cancel()


async def test_a_robot_that_stays_where_it_is_after_the_lesson_is_not_set_down(
    robot: StandInRobot, client: TeacherClient
) -> None:
    mind = streets(robot, 0.5, place=SimulatedPlace(1.0, 2.0, 0.5, 0.0, 0, 0))
    mind.refuses_phase = Phase.AUTONOMOUS
    said: list[str] = []
    with anyio.fail_after(10.0):
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(teach_by_script, client, SETTINGS, short("streets", 1.0), said.append)
            await robot.hears(PhaseRequest, 2)  # phase 1, and 5 at the end
            stays = robot.state.tick
            async for picture in client.states():
                if picture.tick > stays + 80:  # 40 s later
                    break
            robot.show(teacher="anna")
    assert said[-1].endswith("the robot stays where it is; take it and say go to let it drive")
    assert robot.all_of(PlaceRequest) == []
    assert robot.all_of(PursueRequest) == []
    assert robot.state.stopped is not None
    assert robot.state.stopped.reason is StopReason.SESSION_OVER


async def test_a_real_robot_is_not_for_the_scripted_teacher(client: TeacherClient, robot: StandInRobot) -> None:
    robot.mind = Mind(robot, simulated=False)
    with pytest.raises(RefusedError, match="kurt2-indoor is a real robot; the scripted teacher teaches simulated"):
        await teach_by_script(client, SETTINGS, short(), lambda _: None)
    assert {type(each) for each in robot.orders()} == {HelloRequest}


@pytest.mark.parametrize(
    ("hello", "robots"),
    [
        ({"task": "circle"}, "circle,"),
        ({"behaviours": ["there", "back"]}, r"wall_following \(behaviours: there, back\),"),
    ],
)
async def test_a_robot_that_was_started_for_another_task_is_not_taught_this_one(
    client: TeacherClient, robot: StandInRobot, hello: dict[str, object], robots: str
) -> None:
    robot.mind = mind = Mind(robot)
    mind.hello = hello
    why = f"was started for task {robots} and the scripted teacher is to teach wall_following: .*; give it --task "
    with pytest.raises(RefusedError, match=why + str(hello.get("task", "wall_following"))):
        await teach_by_script(client, SETTINGS, short(), lambda _: None)
    assert {type(each) for each in robot.orders()} == {HelloRequest}


async def test_it_says_that_nobody_sets_the_robot_down_elsewhere_where_the_task_asks_for_it(
    client: TeacherClient, robot: StandInRobot
) -> None:
    robot.mind = Mind(robot)
    task = short()
    moved = task.model_copy(update={"teaching": task.teaching.model_copy(update={"reposition_every_s": 7.0})})
    said = await lesson(client, robot, ALONE, moved)
    assert said[0].startswith("task wall_following has the robot set down elsewhere every 7 s; over the channel nobody")


async def test_it_teaches_both_phases_and_lets_the_robot_drive_alone(
    client: TeacherClient, robot: StandInRobot
) -> None:
    robot.mind = Mind(robot)
    said = await lesson(client, robot, ALONE)
    assert said[0].startswith("phase 1 ")
    assert said[-2:] == ["0 lessons given", "now the robot drives alone (phase 5)"]
    assert phases(robot) == [Phase.SUPERVISED, Phase.CORRECTIONS, Phase.AUTONOMOUS]


async def test_answers_that_are_missing_do_not_end_it(client: TeacherClient, robot: StandInRobot) -> None:
    robot.mind = Mind(robot, mute=2)
    said = await lesson(client, robot, ALONE)
    assert said[-1] == "now the robot drives alone (phase 5)"
    assert robot.state.session is None
    assert len(dict.fromkeys(robot.all_of(SessionRequest))) >= 4


async def test_a_robot_that_a_person_stopped_during_the_lesson_stays_where_it_is(
    client: TeacherClient, robot: StandInRobot
) -> None:
    robot.mind = mind = Mind(robot)
    mind.stop_at_phase = Phase.CORRECTIONS
    said = await lesson(client, robot, "stays where it is")
    assert said[-1] == "anna said stop: the robot stays where it is; take it and say go to let it drive"
    assert phases(robot) == [Phase.SUPERVISED, Phase.CORRECTIONS]
    assert robot.all_of(ResumeRequest) == []


async def test_a_robot_that_a_person_stops_at_the_last_moment_stays_where_it_is(
    client: TeacherClient, robot: StandInRobot
) -> None:
    robot.mind = mind = Mind(robot)
    mind.stop_at_phase = Phase.AUTONOMOUS
    said = await lesson(client, robot, "stays where it is")
    assert "the robot stays where it is" in said[-1]
    assert robot.state.stopped == ActiveStop(StopReason.SAID_STOP, "anna")


def test_it_sees_in_a_picture_what_is_wanted_and_which_rla_drives() -> None:
    seen = picture_in(state(cause="rla", action="forward", rla=3, behaviour="turn_left"))
    assert seen == TeacherView(False, True, "forward", state().infrared_counts, "turn_left", 3)
    nearest = picture_in(state(cause="rla", action="forward", rla=3, nearest=3, distance=60.0, radius=600.0))
    assert nearest.share_of_radius == 0.1
