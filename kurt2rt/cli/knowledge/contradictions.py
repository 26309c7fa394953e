"""`kurt2rt knowledge contradictions`."""

from behaviors.action_groups import action_groups
from hal.robot_settings import load_robot_of
from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.knowledge.shared import KnowledgeFile, say
from kurt2rt.cli.options import RobotName, TaskOfTheFile
from kurt2rt.core.critic.sides import critic_of
from kurt2rt.core.outcome_text import neighbours_text
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.rla.contradiction import NEIGHBOURS, Contradiction, find_contradiction
from kurt2rt.core.task_settings import load_task
from kurt2rt.knowledge.files.task_of_file import task_of_file
from kurt2rt.knowledge.journal.loading import read_lessons
from kurt2rt.runtime import empty_system


def contradictions(
    file: KnowledgeFile, task_name: TaskOfTheFile = None, robot_name: RobotName = None, as_json: AsJson = False
) -> None:
    """List the RLAs that none of their neighbours agrees with, as after a slip of the finger.

    An RLA is listed if each of the five RLAs nearest to it does something that
    looks different. About two of five such RLAs are wrong; the others are
    at a place where the right action changes. Look at each, and undo its
    lesson if it is wrong.

    For example:

        kurt2rt knowledge contradictions var/wall_following.knowledge
        kurt2rt knowledge undo var/wall_following.knowledge --lesson LESSON-ID
    """
    name = task_of_file(file, task_name)
    task, robot = load_task(name), load_robot_of(robot_name, name)
    definition = load_situation(task.situation, robot.infrared.names)
    system = empty_system(task, definition, critic_of(task.critic, robot), None)
    system.apply_all(read_lessons(file, robot, task))
    groups = action_groups(task.repertoire)
    found = [each for rla in system.rlas if (each := find_contradiction(system, rla, groups)) is not None]
    if as_json:
        print_json({"file": file, "rlas": len(system.rlas), "contradictions": [_as_data(each) for each in found]})
        return
    for each in found:
        say(_line(each))
    say(f"{file}: {len(found)} of {len(system.rlas)} RLAs contradict their {NEIGHBOURS} nearest neighbours")


def _line(found: Contradiction) -> str:
    rla = found.rla
    near = neighbours_text(found.actions, found.neighbours[0].rla_id)
    return f"{rla.title}: {rla.action}, by {rla.origin.teacher}, lesson {rla.origin.command_id}; {near}"


def _as_data(found: Contradiction) -> dict[str, object]:
    rla = found.rla
    neighbours = [{"rla": each.rla_id, "action": each.action} for each in found.neighbours]
    return {
        "rla": rla.rla_id,
        "action": rla.action,
        "behaviour": rla.behaviour,
        "teacher": rla.origin.teacher,
        "lesson": rla.origin.command_id,
        "neighbours": neighbours,
    }
