"""`kurt2rt knowledge show`, `lessons` and `check`."""

from typing import Annotated, Any

import typer

from behaviors.action_groups import action_groups
from config.errors import ExitCode
from hal.robot_settings import load_robot_of
from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.knowledge.shared import WIDE, KnowledgeFile
from kurt2rt.cli.options import RobotName, TaskOfTheFile
from kurt2rt.cli.tables import console_of, say
from kurt2rt.core.critic.settings import critic_of
from kurt2rt.core.outcome_text import neighbours_text
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.rla.contradiction import NEIGHBOURS, Contradiction, find_contradiction
from kurt2rt.core.task_settings import load_task
from kurt2rt.knowledge.files.task_of_file import task_of_file
from kurt2rt.knowledge.journal.fold import check_knowledge
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import read_lessons
from kurt2rt.knowledge.show.knowledge import knowledge_data, lessons_data, render_knowledge, render_lessons
from kurt2rt.knowledge.show.rla import expectation_data, render_rla
from kurt2rt.platform.text_table import print_whole
from kurt2rt.runtime import empty_system


def show(
    file: KnowledgeFile,
    limit: Annotated[
        int | None,
        typer.Option(metavar="N", min=1, help="Number of RLAs to show, oldest first; with --rla number of features."),
    ] = None,
    rla: Annotated[
        int | None, typer.Option(metavar="N", help="Show all of this RLA, with the situation that it expects next.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """List each RLA: its action, who taught it and when, instead of what, and its use.

    For example:

        kurt2rt knowledge show var/wall_following.knowledge
        kurt2rt knowledge show var/wall_following.knowledge --rla 3
    """
    with Journal.read_only(file) as journal:
        console = console_of()
        if as_json:
            print_json(_as_data(journal, rla, limit))
        elif rla is None:
            print_whole(console, render_knowledge(journal, limit, wide=console.width >= WIDE))
        else:
            print_whole(console, render_rla(journal, rla, limit))


def lessons(
    file: KnowledgeFile,
    limit: Annotated[int, typer.Option(metavar="N", min=1, help="Number of lessons to show, newest first.")] = 20,
    teacher: Annotated[
        str | None, typer.Option(metavar="NAME", help="Only lessons of this teacher; critic: the robot's own critic.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """List the lessons, newest first, with their ids and who undid them.

    For example:

        kurt2rt knowledge lessons var/wall_following.knowledge
        kurt2rt knowledge lessons var/wall_following.knowledge --teacher critic
    """
    with Journal.read_only(file) as journal:
        if as_json:
            print_json(lessons_data(journal, limit, teacher))
        else:
            print_whole(console_of(), render_lessons(journal, limit, teacher))


def check(file: KnowledgeFile, as_json: AsJson = False) -> None:
    """Check that every lesson in the file can be read and fits; exit code 1 if one does not.

    For example:

        kurt2rt knowledge check var/wall_following.knowledge
    """
    with Journal.read_only(file) as journal:
        faults = [str(error) for error in check_knowledge(journal)]
    if as_json:
        print_json({"file": file, "sound": not faults, "faults": faults})
    else:
        for line in faults or [f"{file}: every lesson can be read and fits"]:
            say(line)
    if faults:
        raise typer.Exit(ExitCode.FAILED)


def _as_data(journal: Journal, rla_id: int | None, limit: int | None) -> dict[str, Any]:
    """Return all RLAs, the first `limit` of them, or one with what is expected to follow it."""
    data = knowledge_data(journal)
    if rla_id is None:
        return {**data, "rlas": data["rlas"][:limit], "hidden": len(data["rlas"][limit:]) if limit else 0}
    expected = expectation_data(journal, rla_id)
    (rla,) = (each for each in data["rlas"] if each["rla"] == rla_id)
    return {"file": data["file"], **rla, "expected": expected}


def contradictions(
    file: KnowledgeFile, task_name: TaskOfTheFile = None, robot_name: RobotName = None, as_json: AsJson = False
) -> None:
    """List RLAs that contradict all of their neighbours, often after a wrong press.

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
    system = empty_system(robot, task, definition, critic_of(task.critic, robot), None)
    system.apply_all(read_lessons(file, robot, task))
    groups = action_groups(task.repertoire)
    found = [each for rla in system.rlas if (each := find_contradiction(system, rla, groups)) is not None]
    if as_json:
        print_json(
            {"file": file, "rlas": len(system.rlas), "contradictions": [_contradiction_data(each) for each in found]}
        )
        return
    for each in found:
        say(_contradiction_line(each))
    say(f"{file}: {len(found)} of {len(system.rlas)} RLAs contradict their {NEIGHBOURS} nearest neighbours")


def _contradiction_line(found: Contradiction) -> str:
    rla = found.rla
    near = neighbours_text(found.actions, found.neighbours[0].rla_id)
    return f"{rla.title}: {rla.action}, by {rla.origin.teacher}, lesson {rla.origin.command_id}; {near}"


def _contradiction_data(found: Contradiction) -> dict[str, object]:
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
