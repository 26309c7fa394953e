"""Scripted teacher over the channel: it sees the states of a person's page and gives a person's commands."""

from collections.abc import Awaitable, Callable
from contextlib import suppress
from functools import partial

import anyio

from hal.robot_settings import RobotSettings
from kurt2rt.channel.protocol.hello import Hello
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.decision.decision import ASKING
from kurt2rt.core.decision.standing import ActiveStop, StopReason, stop_text
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.commands import BeginSession, EndSession, Resume, SetLessonSpeed, SetPhase, Take
from kurt2rt.teacher.client.answer import Answer, NoAnswerError, RefusedError
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.scripted.basic_teacher import BasicTeacher, TeacherView
from kurt2rt.teacher.scripted.build import build_teacher
from kurt2rt.teacher.scripted.command_sender import CommandSender
from kurt2rt.teacher.scripted.supervisor import ScriptedSupervisor

Say = Callable[[str], None]

_STOPPED = "stopped"
_RETRY_S = 0.2


async def teach_by_script(
    robot: TeacherClient, settings: RobotSettings, task: TaskSettings, say: Say, *, seed: int = 1
) -> None:
    """Teach a task for its whole time, then let the robot drive alone until another teacher takes it.

    The behaviours of the task are selected in turn, and a robot without progress is put elsewhere. A robot that a
    person stopped stays where it is.

    Args:
        robot: connected client.
        settings: of the robot.
        task: to teach; the robot must run it.
        say: gets lines for the user.
        seed: random choices of the teacher.

    Raises:
        NoAnswerError: the robot is not there at the beginning.
        RefusedError: it is a real robot, runs another task, or refuses the teacher.
        SettingsError: the repertoire of the task is missing or invalid.
    """
    if task.mid is not None:
        raise RefusedError(mid_level_refusal(task))
    hello = await robot.hello()
    if not hello.simulated:
        raise RefusedError(f"{hello.robot} is a real robot; the scripted teacher teaches simulated ones only")
    if (hello.task, hello.behaviours) != (task.name, task.behaviours):
        raise RefusedError(_task_refusal(hello, task))
    teacher = build_teacher(task, settings, hello.actions, seed=seed, session="unused")
    supervisor = ScriptedSupervisor(robot, task, hello.period_s, seed, say)
    profile = task.teaching.profile
    await _begin(robot, f"scripted, {profile.name}, seed {seed}")
    percent = round(100 * task.teaching.lesson_speed)
    if percent < 100:
        await _must(robot, lambda: robot.send(SetLessonSpeed, percent=percent), lambda state: state.lesson_speed < 1.0)
        say(f"slow lessons: the robot drives at {percent} % of the speed of its actions in phases 1 and 2")
    if task.teaching.reposition_every_s:
        say(_reposition_notice(task))
    if supervisor.plan:
        say(supervisor.plan)
    say(f"phase 1 for {task.teaching.supervised_s:.0f} s: answers, by the scripted teacher {profile.name}")
    lessons = await _teach(robot, teacher, supervisor, task, hello.period_s, say)
    if lessons is None:
        return
    say(f"{lessons} lessons given")
    await _let_drive_alone(robot, say)
    await _supervise_alone(robot, supervisor)


async def _begin(robot: TeacherClient, session: str) -> None:
    await _must(robot, lambda: robot.send(Take), lambda state: state.teacher == robot.name)
    await _must(robot, lambda: robot.send(BeginSession, name=session), lambda state: state.session == session)
    await _must(
        robot, lambda: robot.send(SetPhase, phase=Phase.SUPERVISED), lambda state: state.phase == Phase.SUPERVISED
    )


async def _teach(
    robot: TeacherClient,
    teacher: BasicTeacher,
    supervisor: ScriptedSupervisor,
    task: TaskSettings,
    period_s: float,
    say: Say,
) -> int | None:
    """Teach phases 1 and 2; return the number of lessons, None if another teacher took the robot."""
    corrections_from = round(task.teaching.supervised_s / period_s)
    over_at = round(task.teaching.duration_s / period_s)
    sender, lessons = CommandSender(robot), 0
    first: int | None = None
    before = 0
    async for state in robot.states():
        if state.teacher != robot.name:
            say(f"{state.teacher or 'another teacher'} took the robot; the scripted teacher stops here")
            return None
        if first is None:
            first = before = state.tick
        if state.tick - first >= over_at:
            with suppress(NoAnswerError):  # without messages the robot ends the hold itself
                await robot.let_go()
            break
        if teacher.phase is Phase.SUPERVISED and state.tick - first >= corrections_from:
            teacher.begin_phase(Phase.CORRECTIONS)
            await _must(
                robot,
                lambda: robot.send(SetPhase, phase=Phase.CORRECTIONS),
                lambda state: state.phase == Phase.CORRECTIONS,
            )
            say(f"phase 2 for {task.teaching.corrections_s:.0f} s: corrections as well")
        await _resume_if_self_stopped(robot, state)
        await supervisor.update(state, stopped=_person_stop(robot, state) is not None)
        command = teacher.update(view_of_state(state), state.tick - before)
        before = state.tick
        # A teacher who looks back resumes after a stop of its own only.
        lifts_stop = isinstance(command, Resume) and _person_stop(robot, state) is not None
        if command is not None and not lifts_stop:
            lessons += await sender.send(command, state.tick)
    return lessons


async def _supervise_alone(robot: TeacherClient, supervisor: ScriptedSupervisor) -> None:
    async for state in robot.states():
        if state.teacher != robot.name:
            return
        if supervisor.plan:
            await _resume_if_self_stopped(robot, state)  # a robot that was put elsewhere has to be resumed
        over = state.stopped is not None and state.stopped.reason is StopReason.SESSION_OVER
        await supervisor.update(state, stopped=over or _person_stop(robot, state) is not None)


def mid_level_refusal(task: TaskSettings) -> str:
    """Return the sentence that refuses a task over the channel; the caller has checked that it has a mid level."""
    return (
        f"task {task.name} has a mid level, and over the channel the scripted teacher does not see the streets that "
        f"say which way is right; kurt2rt train --task {task.name} teaches it in simulated time"
    )


def _task_refusal(hello: Hello, task: TaskSettings) -> str:
    robots, own = (
        f"{name} (behaviours: {', '.join(behaviours)})" if behaviours != ("",) else name
        for name, behaviours in ((hello.task, hello.behaviours), (task.name, task.behaviours))
    )
    return (
        f"the robot was started for task {robots}, and the scripted teacher is to teach {own}: what it answered would "
        f"be lessons of another task; give it --task {hello.task} (or the path of that task's file), or start the "
        f"robot with --task {task.name}"
    )


def _reposition_notice(task: TaskSettings) -> str:
    return (
        f"task {task.name} wants the robot put elsewhere every {task.teaching.reposition_every_s:g} s, which is not "
        f"done over the channel; kurt2rt train --task {task.name} does it, in simulated time"
    )


async def _let_drive_alone(robot: TeacherClient, say: Say) -> None:
    # Read before the session ends: its end gives the robot another reason to stand.
    stop = _person_stop(robot, await _state_at(robot, 0))
    ended = await _must(robot, lambda: robot.send(EndSession), lambda state: state.session is None)
    stop = stop or _person_stop(robot, await _state_at(robot, ended.tick))
    stopped = "" if stop is None else stop_text(stop)

    async def unless_stopped(give: Callable[[], Awaitable[Answer]]) -> Answer:
        state = await _state_at(robot, 0)
        # Without an await in between: the robot refuses the command if it was stopped after this state.
        stop = _person_stop(robot, state)
        return Answer(False, _STOPPED, stop_text(stop), state.tick) if stop is not None else await give()

    if not stopped:
        say("now the robot drives alone (phase 5)")
        for give in (lambda: robot.send(SetPhase, phase=Phase.AUTONOMOUS), lambda: robot.send(Resume)):
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


async def _resume_if_self_stopped(robot: TeacherClient, state: State) -> None:
    if state.stopped is not None and state.stopped.is_automatic:
        with suppress(NoAnswerError):  # the next state shows whether it is still needed
            await robot.send(Resume)


def _person_stop(robot: TeacherClient, state: State) -> ActiveStop | None:
    """Return the stop that holds; None if this teacher, the end of its session, the guard or the link is the reason."""
    stop = state.stopped
    if stop is None or stop.is_automatic or stop.reason is StopReason.SESSION_OVER or stop.teacher == robot.name:
        return None
    return stop


async def _state_at(robot: TeacherClient, tick: int) -> State:
    """Wait for a state of a tick or later, or of another teacher. Raises NoAnswerError."""
    async for state in robot.states():
        if state.tick >= tick or state.teacher != robot.name:
            return state
    raise NoAnswerError("no more states come")


def view_of_state(state: State) -> TeacherView:
    """Return a scripted teacher's view of a state that came over the channel; bumpers tell of touches."""
    return TeacherView(
        asking=state.cause in ASKING,
        driving=state.action is not None,
        action=state.action,
        infrared_counts=state.infrared_counts,
        behaviour=state.behaviour,
        tick=state.tick,
        touching=state.bumpers != 0,
    )


async def _must(robot: TeacherClient, give: Callable[[], Awaitable[Answer]], done: Callable[[State], bool]) -> Answer:
    """Repeat a command until the robot answers; a stop that comes first is an answer. Raises RefusedError.

    `done` tells from a state whether an earlier try, whose answer was lost, was carried out.
    """
    tries = 0
    while True:
        tries += 1
        try:
            got = await give()
        except NoAnswerError:
            await anyio.sleep(_RETRY_S)
            continue
        if got.accepted or got.why == _STOPPED:
            return got
        if tries > 1 and done(await _state_at(robot, got.tick)):
            return got
        raise RefusedError(f"the robot refuses the scripted teacher: {got.text}")
