"""An order of a page becomes a command to the robot."""

from kurt2rt.channel.protocol.requests import PACKAGE
from kurt2rt.core.rla.rla import Phase
from kurt2rt.teacher.client.answer import Answer
from kurt2rt.teacher.page.messages import PageOrder
from kurt2rt.teacher.page.robot_link import RobotLink

_MOVING = ("take", "place", "put_back", "pursue", "seek", "stop_seeking")
_MOVING_S = 1.0
_OTHERS_S = 3.0


def oldest_picture_s(order: PageOrder) -> float:
    """How long ago the page's picture may have been sent, in s: the robot's own borders, for the page's own link."""
    return _MOVING_S if lets_drive(order) or order.name in _MOVING else _OTHERS_S


def lets_drive(order: PageOrder) -> bool:
    """Whether a robot that stands may drive by it: never one that was stopped after the picture."""
    return order.name == "resume" or (order.name == "phase" and order.arguments["phase"] == Phase.AUTONOMOUS)


def ends_run(order: PageOrder) -> bool:
    """Whether the robot's run ends by it: no more pictures come of that one, and its wheels stand."""
    return order.name in ("next_run", "load")


async def carry_out(order: PageOrder, robot: RobotLink, of: int | None) -> Answer:
    """Tell the robot, `of` being the tick of the picture that the page showed. Raises NoAnswerError."""
    given = order.arguments
    match order.name:
        case "answer":
            return await robot.answer(given["action"], of=of, level=given["level"], alternative=given["beside"])
        case "correct":
            return await robot.correct(given["action"], of=of, level=given["level"])
        case "reward":
            return await robot.reward(given["value"], of=of)
        case "appraise":
            return await robot.appraise(given["appraisal"], of=of)
        case "undo":
            return await robot.undo(given["lesson"])
        case "phase":
            return await robot.set_phase(given["phase"])
        case "pursue":
            return await robot.pursue(given["behaviour"])
        case "name":
            return await robot.name_situation(given["name"], of=of)
        case "seek":
            return await robot.seek(given["name"])
        case "stop_seeking":
            return await robot.stop_seeking()
        case "be_at":
            return await robot.set_location(given["name"])
        case "begin_session":
            return await robot.begin_session(given["name"])
        case "end_session":
            return await robot.end_session()
        case "resume":
            return await robot.resume()
        case "take":
            return await robot.take()
        case "hand_over":
            return await robot.hand_over(given["to"])
        case "save":
            return await robot.save(given["label"])
        case "export":
            return await robot.export(PACKAGE)
        case "examine":
            return await robot.examine()
        case "move":
            return await robot.move_wall(given["name"], given["dx_m"], given["dy_m"])
        case "put_back":
            return await robot.put_back()
        case "speed":
            return await robot.set_speed(given["times"])
        case "load":
            return await robot.load_upload(given["upload"], given["sha256"])
        case "next_run":
            return await robot.next_run(given["world"], given["task"], fresh=given["fresh"])
        case "place":
            return await robot.place(given["x_m"], given["y_m"], given["heading_rad"])
    raise AssertionError(order.name)
