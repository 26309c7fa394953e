"""Commands of a scripted teacher over the channel: an undo names the lesson of the press, or is not sent."""

from kurt2rt.channel.protocol.requests import StopRequest
from kurt2rt.channel.server.reply import Reply, done
from kurt2rt.core.rla.lesson_history import hold_id
from kurt2rt.core.rla.rla import SCRIPTED
from kurt2rt.core.teaching.commands import Correct, HoldAction, Stop, Undo
from kurt2rt.teacher import TeacherClient
from kurt2rt.teacher.scripted.command_sender import CommandSender
from tests.teacher.client.test_client import wait_for_answers
from tests.teacher.stand_in_robot import SlowMind, StandInRobot

TICK = 40
WRONG = Correct("s-7", SCRIPTED, "back", decision_tick=TICK)
UNDO = Undo("s-8", SCRIPTED, WRONG.command_id)


def teaches(robot: StandInRobot, lesson: str | None) -> None:
    """Let the robot answer each press with the id of a lesson."""

    async def answer(request: object) -> Reply:
        return done(TICK, lesson=lesson if isinstance(request, Correct | StopRequest) else None)

    robot.mind = answer


async def test_send_undo_names_the_lesson_of_the_press(robot: StandInRobot, client: TeacherClient) -> None:
    sender = CommandSender(client)
    teaches(robot, "auto-0a")
    await sender.send(WRONG, TICK)
    teaches(robot, "auto-0b")
    await sender.send(Correct("s-9", SCRIPTED, "forward"), TICK)
    await sender.send(UNDO, TICK)
    assert [each.lesson for each in robot.all_of(Undo)] == ["auto-0a"]


async def test_send_undo_of_a_press_that_taught_nothing_is_not_sent(robot: StandInRobot, client: TeacherClient) -> None:
    sender = CommandSender(client)
    teaches(robot, None)
    assert await sender.send(WRONG, TICK) == 1
    robot.mind = SlowMind(Correct)
    wait_for_answers(client, 0.1)
    assert await sender.send(WRONG, TICK) == 0, "its answer is lost"
    await sender.send(UNDO, TICK)
    assert robot.all_of(Undo) == []


async def test_send_undo_of_a_hold_names_all_its_lessons(robot: StandInRobot, client: TeacherClient) -> None:
    sender = CommandSender(client)
    teaches(robot, "auto-hold-1790")
    await sender.send(HoldAction(SCRIPTED, TICK, 3, "back"), TICK)
    assert await sender.send(Stop("s-1", SCRIPTED, 3), TICK) == 1
    await sender.send(Undo("s-2", SCRIPTED, hold_id(SCRIPTED, 3)), TICK)
    assert [each.lesson for each in robot.all_of(Undo)] == ["auto-hold-1790"]
