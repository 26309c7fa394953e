"""The scripted teacher over the channel: it sees what a person's page sees, and says what a person could say."""

from collections.abc import Awaitable, Callable

from hal.robot_settings import RobotSettings
from kurt2rt.channel.state import State
from kurt2rt.layers.decision import Cause
from kurt2rt.rla.rla import Phase
from kurt2rt.tasks.settings import TaskSettings
from kurt2rt.teaching.answer import Answer, NoAnswerError
from kurt2rt.teaching.client import TeacherClient
from kurt2rt.teaching.commands import Command, Correct, Teach
from kurt2rt.teaching.scripted_teacher import Picture, teacher_of

Say = Callable[[str], None]

_STOPPED_ITSELF = ("the guard", "lost the link")
"""Reasons that a simulated robot may be told to go on after, unlike a person's stop."""


async def teach_by_script(
    robot: TeacherClient, settings: RobotSettings, task: TaskSettings, say: Say, *, seed: int = 1
) -> None:
    """Teach the task for its whole time, then let the robot drive alone and look on, until cancelled.

    Raises NoAnswerError when the robot is not there.
    """
    hello = await robot.hello()
    teacher = teacher_of(task, settings, hello.actions, seed=seed, session="unused")
    corrections_from = round(task.teaching.supervised_s / hello.period_s)
    over_at = round(task.teaching.duration_s / hello.period_s)
    said = 0
    await _must(robot.take())
    await _must(robot.begin_session(f"scripted, seed {seed}"))
    await _must(robot.set_phase(Phase.SUPERVISED))
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
            await _must(robot.set_phase(Phase.CORRECTIONS))
            say(f"phase 2 for {task.teaching.corrections_s:.0f} s: corrections as well")
        if state.stopped_because.startswith(_STOPPED_ITSELF):
            await robot.resume()
        command = teacher.watch(picture_in(state), state.tick - before)
        before = state.tick
        if command is not None:
            said += await _say(robot, command, state.tick)
    await _must(robot.end_session())
    say(f"{said} lessons given; now the robot drives alone (phase 5)")
    await _must(robot.set_phase(Phase.AUTONOMOUS))
    await _must(robot.resume())
    async for state in robot.states():
        if state.teacher != robot.name:
            return


def picture_in(state: State) -> Picture:
    """What the picture on the wire shows a teacher."""
    return Picture(state.cause == Cause.UNKNOWN, state.action is not None, state.action, state.infrared_counts)


async def _say(robot: TeacherClient, command: Command, tick: int) -> int:
    """Say it; how many lessons came of it. A bad link costs a lesson, not the session."""
    try:
        match command:
            case Teach(action=action):
                answer = await robot.answer(action, of=tick)
            case Correct(action=action):
                answer = await robot.correct(action, of=tick)
            case _:
                raise AssertionError(f"a scripted teacher does not say {command}")
    except NoAnswerError:
        return 0
    return int(answer.accepted)


async def _must(answer: Awaitable[Answer]) -> None:
    got = await answer
    if not got.accepted:
        raise RefusedError(f"the robot refuses the scripted teacher: {got.text}")


class RefusedError(Exception):
    """The robot does not take what the scripted teacher cannot do without. One line."""
