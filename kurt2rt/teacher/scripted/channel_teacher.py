"""The scripted teacher over the channel: it sees what a person's page sees, and says what a person could say."""

from collections.abc import Awaitable, Callable
from contextlib import suppress
from functools import partial

import anyio

from hal.robot_settings import RobotSettings
from kurt2rt.channel.protocol.hello import Hello
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.decision.active_stop import ActiveStop, StopReason
from kurt2rt.core.decision.decision import Cause
from kurt2rt.core.decision.standing_text import stop_text
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.commands import Command, Correct, DeleteRla, Teach
from kurt2rt.teacher.client.answer import Answer, NoAnswerError, RefusedError
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.scripted.supervisor import ScriptedSupervisor
from kurt2rt.teacher.scripted.teacher import TeacherView, share_of_radius, teacher_of

Say = Callable[[str], None]

_STOPPED = "stopped"
_AGAIN_S = 0.2


async def teach_by_script(
    robot: TeacherClient, settings: RobotSettings, task: TaskSettings, say: Say, *, seed: int = 1
) -> None:
    """Teach the task for its whole time, then let the robot drive alone and look on, until cancelled.

    Several behaviours are wanted in turn, and a robot that makes no way with them is set down elsewhere. One that a
    person stopped stays where it is. Raises NoAnswerError when the robot is not there at the beginning, and
    RefusedError when it is no simulated one, was started for another task, or refuses its teacher.
    """
    if task.mid is not None:
        raise RefusedError(two_levels(task))
    hello = await robot.hello()
    if not hello.simulated:
        raise RefusedError(f"{hello.robot} is a real robot; the scripted teacher teaches simulated ones only")
    if (hello.task, hello.behaviours) != (task.name, task.behaviours):
        raise RefusedError(_another_task(hello, task))
    teacher = teacher_of(task, settings, hello.actions, seed=seed, session="unused")
    corrections_from = round(task.teaching.supervised_s / hello.period_s)
    over_at = round(task.teaching.duration_s / hello.period_s)
    said = 0
    session = f"scripted, seed {seed}"
    await _must(robot, robot.take, lambda state: state.teacher == robot.name)
    await _must(robot, lambda: robot.begin_session(session), lambda state: state.session == session)
    await _must(robot, lambda: robot.set_phase(Phase.SUPERVISED), lambda state: state.phase == Phase.SUPERVISED)
    if task.teaching.reposition_every_s:
        say(_nobody_sets_it_down(task))
    leading = ScriptedSupervisor(robot, task, hello.period_s, seed, say)
    if leading.plan:
        say(leading.plan)
    say(f"phase 1 for {task.teaching.supervised_s:.0f} s: answers")
    first: int | None = None
    before = 0
    async for state in robot.states():
        if state.teacher != robot.name:
            say(f"{state.teacher or 'somebody else'} took the robot; the scripted teacher stops here")
            return
        if first is None:
            first = before = state.tick
        if state.tick - first >= over_at:
            break
        if teacher.phase is Phase.SUPERVISED and state.tick - first >= corrections_from:
            teacher.enter(Phase.CORRECTIONS)
            await _must(
                robot, lambda: robot.set_phase(Phase.CORRECTIONS), lambda state: state.phase == Phase.CORRECTIONS
            )
            say(f"phase 2 for {task.teaching.corrections_s:.0f} s: corrections as well")
        await _go_on(robot, state)
        await leading.see(state, stopped=_stopped_by_a_person(robot, state) is not None)
        command = teacher.watch(picture_in(state), state.tick - before)
        before = state.tick
        if command is not None:
            said += await _say(robot, command, state.tick)
    say(f"{said} lessons given")
    await _let_drive_alone(robot, say)
    async for state in robot.states():
        if state.teacher != robot.name:
            return
        if leading.plan:
            await _go_on(robot, state)  # where it has been set down it has to be told to
        over = state.stopped is not None and state.stopped.reason is StopReason.SESSION_OVER
        await leading.see(state, stopped=over or _stopped_by_a_person(robot, state) is not None)


def two_levels(task: TaskSettings) -> str:
    """Why the scripted teacher does not teach such a task over the channel."""
    return (
        f"task {task.name} has a mid level, and over the channel the scripted teacher does not see the streets that "
        f"say which way is right; kurt2rt lesson --task {task.name} teaches it in simulated time"
    )


def _another_task(hello: Hello, task: TaskSettings) -> str:
    robots, own = (
        f"{name} (behaviours: {', '.join(behaviours)})" if behaviours != ("",) else name
        for name, behaviours in ((hello.task, hello.behaviours), (task.name, task.behaviours))
    )
    return (
        f"the robot was started for task {robots}, and the scripted teacher is to teach {own}: what it answered would "
        f"be lessons of another task; give it --task {hello.task} (or the path of that task's file), or start the "
        f"robot with --task {task.name}"
    )


def _nobody_sets_it_down(task: TaskSettings) -> str:
    return (
        f"task {task.name} has the robot set down elsewhere every {task.teaching.reposition_every_s:g} s; over the "
        f"channel nobody does, nor where it makes no way; kurt2rt lesson --task {task.name} does, in simulated time"
    )


async def _let_drive_alone(robot: TeacherClient, say: Say) -> None:
    # Looked at before the session ends: its end gives the robot another reason to stand.
    stop = _stopped_by_a_person(robot, await _picture(robot, 0))
    ended = await _must(robot, robot.end_session, lambda state: state.session is None)
    stop = stop or _stopped_by_a_person(robot, await _picture(robot, ended.tick))
    stopped = "" if stop is None else stop_text(stop)

    async def unless_stopped(give: Callable[[], Awaitable[Answer]]) -> Answer:
        state = await _picture(robot, 0)
        # Nothing is awaited between this look and the saying: the robot refuses it if it is stopped after this picture.
        because = _stopped_by_a_person(robot, state)
        return Answer(False, _STOPPED, stop_text(because), state.tick) if because is not None else await give()

    if not stopped:
        say("now the robot drives alone (phase 5)")
        for give in (lambda: robot.set_phase(Phase.AUTONOMOUS), robot.resume):
            try:
                got = await _must(robot, partial(unless_stopped, give), lambda _: False)
            except RefusedError as error:
                stopped = str(error)
                break
            if got.why == _STOPPED:
                stopped = got.text
                break
    if stopped:
        say(f"{stopped}: the robot stays where it is; take it and say go to let it drive")


async def _go_on(robot: TeacherClient, state: State) -> None:
    """Tell a robot that stopped itself to go on."""
    if state.stopped is not None and state.stopped.lifts_itself:
        with suppress(NoAnswerError):  # the next picture shows whether it has to be said again
            await robot.resume()


def _stopped_by_a_person(robot: TeacherClient, state: State) -> ActiveStop | None:
    """Return the stop that holds; None if this teacher, the end of its session, the guard or the link is the reason."""
    stop = state.stopped
    if stop is None or stop.lifts_itself or stop.reason is StopReason.SESSION_OVER or stop.teacher == robot.name:
        return None
    return stop


async def _picture(robot: TeacherClient, tick: int) -> State:
    """The newest one, of that tick or a later one while this teacher teaches."""
    async for state in robot.states():
        if state.tick >= tick or state.teacher != robot.name:
            return state
    raise NoAnswerError("no more pictures come")


def picture_in(state: State) -> TeacherView:
    """What the picture on the wire shows a teacher."""
    return TeacherView(
        state.cause in (Cause.UNKNOWN, Cause.TOUCHES),
        state.action is not None,
        state.action,
        state.infrared_counts,
        state.behaviour,
        state.rla,
        share_of_radius(state.rla, state.nearest, state.distance, state.radius),
    )


async def _say(robot: TeacherClient, command: Command, tick: int) -> int:
    """Say it; how many lessons came of it. A bad link costs a lesson, not the session."""
    try:
        match command:
            case Teach(action=action):
                answer = await robot.answer(action, of=tick)
            case Correct(action=action):
                answer = await robot.correct(action, of=tick)
            case DeleteRla(rla_id=rla_id):
                answer = await robot.delete(rla_id)
            case _:
                raise AssertionError(f"a scripted teacher does not say {command}")
    except NoAnswerError:
        return 0
    return int(answer.accepted)


async def _must(robot: TeacherClient, give: Callable[[], Awaitable[Answer]], done: Callable[[State], bool]) -> Answer:
    """Say it until the robot answers; a stop may come first, which is an answer, too. Raises RefusedError.

    `done` tells in a picture that an earlier try counted, whose answer was lost.
    """
    tries = 0
    while True:
        tries += 1
        try:
            got = await give()
        except NoAnswerError:
            await anyio.sleep(_AGAIN_S)
            continue
        if got.accepted or got.why == _STOPPED:
            return got
        if tries > 1 and done(await _picture(robot, got.tick)):
            return got
        raise RefusedError(f"the robot refuses the scripted teacher: {got.text}")
