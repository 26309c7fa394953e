"""teach_by_script: a real client, and a robot whose answers are the test's."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import anyio
import pytest

from hal.robot_settings import load_robot
from kurt2rt.channel.protocol.requests import HelloRequest, PlaceRequest, StopRequest
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
from tests.patience import PATIENCE_S, eventually
from tests.teacher.stand_in_robot import INTRODUCED, Message, StandInRobot
from tests.teacher.states_of import state_where

SETTINGS = load_robot("kurt2")
_CarriedOut = Take | SetPhase | Pursue | BeginSession | EndSession | Resume


def short(name: str = "wall_following", each_phase_s: float = 0.1, corrections_s: float | None = None) -> TaskSettings:
    """Return a task whose phases 1 and 2 last `each_phase_s` each; `corrections_s`: phase 2 lasts longer."""
    task = load_task(name)
    both = {"supervised_s": each_phase_s, "corrections_s": corrections_s or each_phase_s}
    teaching = task.teaching.model_copy(update=both)
    return task.model_copy(update={"teaching": teaching})


class Mind:
    """Robot that carries out commands, and whose introduction is changed by `hello`."""

    def __init__(self, robot: StandInRobot, **hello: object) -> None:
        self._robot = robot
        self._hello = {**INTRODUCED.body, "behaviours": [""], **hello}
        self._done: set[str] = set()
        self.stop_at_phase: Phase | None = None
        self._stopped_tick = -1

    async def __call__(self, request: Message) -> Reply:
        if isinstance(request, HelloRequest):
            return Reply(ReplyStatus.DONE, self._hello)
        if isinstance(request, _CarriedOut) and request.command_id not in self._done:
            self._done.add(request.command_id)
            return self._carry_out(request)
        return done(self._robot.state.tick)

    def stop(self) -> None:
        """Stop as teacher anna."""
        self._stopped_tick = self._robot.show(stopped=ActiveStop(StopReason.SAID_STOP, "anna")).tick

    def _carry_out(self, request: _CarriedOut) -> Reply:
        robot = self._robot
        match request:
            case Take():
                robot.show(teacher="auto")
            case SetPhase(phase=phase):
                robot.show(phase=int(phase))
                if phase is self.stop_at_phase:
                    self.stop()
            case Pursue(behaviour=behaviour):
                robot.show(behaviour=behaviour)
            case EndSession():
                robot.show(session=None, stopped=ActiveStop(StopReason.SESSION_OVER, robot.state.session or ""))
            case BeginSession(name=name):
                robot.show(session=name, stopped=None)
            case Resume(seen_tick=int(seen)) if seen < self._stopped_tick:
                return refusal("stopped", Outcome(RefusalCode.STOPPED_SINCE), robot.state.tick)
            case Resume():
                robot.show(stopped=None)
        return done(robot.state.tick)


@pytest.fixture
def robot(robot: StandInRobot) -> StandInRobot:
    """Return a robot that stands and has no session."""
    robot.mind = Mind(robot)
    robot.show(session=None, phase=1, cause="stopped")
    return robot


@asynccontextmanager
async def taught(client: TeacherClient, robot: StandInRobot, task: TaskSettings) -> AsyncIterator[list[str]]:
    """Let the script teach until the block ends, where anna takes the robot; yield the lines that it says."""
    said: list[str] = []
    with anyio.fail_after(PATIENCE_S):
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(teach_by_script, client, SETTINGS, task, said.append)
            yield said
            robot.show(teacher="anna")


async def test_teach_by_script_task_with_a_mid_level_is_refused(robot: StandInRobot, client: TeacherClient) -> None:
    with pytest.raises(RefusedError, match=r"\broute\b.* kurt2rt train --task route"):
        await teach_by_script(client, load_robot(), load_task("route"), print)
    assert robot.state.teacher != AUTO


STREETS = load_task("streets")
TURNS = list(STREETS.behaviours)


DRIVES = {"cause": "rla", "action": "forward", "rla": 1, "place": SimulatedPlace(1.0, 2.0, 0.5, 0.0, 0, 0)}


def streets(robot: StandInRobot, period_s: float, **shown: object) -> Mind:
    """Start the robot for the streets, with long ticks so that 30 s are soon over."""
    robot.mind = mind = Mind(robot, task="streets", behaviours=TURNS, period_s=period_s)
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
    async with anyio.create_task_group() as tasks:
        tasks.start_soon(show_when_seen, robot, client)
        async with taught(client, robot, short("streets", 20.0)) as said:
            heard = await robot.hears(Pursue)
            while len({each.behaviour for each in heard}) < len(TURNS):
                heard = await robot.hears(Pursue, len(heard) + 1)
        tasks.cancel_scope.cancel()
    wanted = [each.behaviour for each in robot.all_of(Pursue)]
    assert list(dict.fromkeys(wanted)) == ["turn_left", "turn_right", "straight_on"]
    assert said[0].startswith("straight_on, turn_left, turn_right: ")
    assert " 30 s, " in said[0]
    turns = [f"{each}, for 30 s" for each in (*TURNS, TURNS[0])]
    alone = next(line for line in said if "(phase 5)" in line)
    assert [line for line in said if line in (*turns, alone)] == [*turns[:2], alone, *turns[2:]]


async def test_teach_by_script_without_progress_repositions_the_robot(
    robot: StandInRobot, client: TeacherClient
) -> None:
    streets(robot, 0.5, **DRIVES)
    async with taught(client, robot, STREETS) as said:
        (first, *_) = await robot.hears(PlaceRequest)
        await eventually(lambda: said[-1].startswith("no progress for 15 s"))
    assert (first.x_m, first.y_m, first.heading_rad) == (1.0, 2.0, 0.5)


async def test_teach_by_script_person_s_stop_ends_commands(robot: StandInRobot, client: TeacherClient) -> None:
    mind = streets(robot, 0.5, **DRIVES)
    async with taught(client, robot, STREETS) as said:
        await robot.hears(SetPhase)
        mind.stop()
        stopped = robot.state.tick
        await state_where(client, lambda state: state.tick > stopped + 100)  # 50 s later
    assert robot.all_of(Pursue) == []
    assert robot.all_of(PlaceRequest) == []
    assert robot.all_of(Resume) == []
    assert robot.state.stopped == ActiveStop(StopReason.SAID_STOP, "anna")
    assert said[-1].startswith("anna ")


async def test_teach_by_script_phase_5_guard_stop_is_resumed(robot: StandInRobot, client: TeacherClient) -> None:
    streets(robot, 0.5, **DRIVES)
    async with taught(client, robot, short("streets", 1.0)):
        await robot.hears(Resume)
        robot.show(stopped=ActiveStop(StopReason.GUARD, "wheels disobey"))
        await robot.hears(Resume, 2)


async def test_teach_by_script_holding_teacher_holds_and_lets_go(robot: StandInRobot, client: TeacherClient) -> None:
    holding = QUICK_TEACHER.model_copy(update={"corrects_by": "hold", "hold_s": 0.2})
    async with taught(client, robot, taught_by(short(corrections_s=2.0), holding)):
        await robot.hears(SetPhase, 2)
        robot.show(cause="rla", action="back", rla=1)
        (held, *_) = await robot.hears(HoldAction)
        (released, *_) = await robot.hears(StopRequest)
    assert held.action != "back"
    assert released.press_id == held.press_id


async def test_teach_by_script_rewinding_teacher_stops_and_resumes(robot: StandInRobot, client: TeacherClient) -> None:
    rewinding = QUICK_TEACHER.model_copy(update={"corrects_by": "rewind"})
    async with taught(client, robot, taught_by(short(corrections_s=2.0), rewinding)):
        await robot.hears(SetPhase, 2)
        wrong = robot.show(cause="rla", action="back", rla=1)
        (stop, *_) = await robot.hears(StopRequest)
        robot.show(cause="stopped", action=None, rla=None, stopped=ActiveStop(StopReason.SAID_STOP, "auto"))
        (correction, *_) = await robot.hears(Correct)
        await robot.hears(Resume)
    assert stop.press_id is None
    assert correction.action != "back"
    assert correction.decision_tick == wrong.tick


@pytest.mark.parametrize(
    ("hello", "why"),
    [
        ({"simulated": False}, "kurt2-indoor is a real robot"),
        ({"task": "circle"}, "task circle, .*wall_following.*--task circle"),
        (
            {"behaviours": ["there", "back"]},
            r"task wall_following \(behaviours: there, back\), .*wall_following.*--task wall_following",
        ),
    ],
)
async def test_teach_by_script_real_robot_or_other_task_is_refused(
    client: TeacherClient, robot: StandInRobot, hello: dict[str, object], why: str
) -> None:
    robot.mind = Mind(robot, **hello)
    with pytest.raises(RefusedError, match=why):
        await teach_by_script(client, SETTINGS, short(), lambda _: None)
    assert {type(each) for each in robot.orders()} == {HelloRequest}


async def test_teach_by_script_stop_at_phase_5_keeps_it_there(client: TeacherClient, robot: StandInRobot) -> None:
    robot.mind = mind = Mind(robot)
    mind.stop_at_phase = Phase.AUTONOMOUS
    async with taught(client, robot, short()) as said:
        await eventually(lambda: said and "the robot stays" in said[-1])
    assert robot.state.stopped == ActiveStop(StopReason.SAID_STOP, "anna")
