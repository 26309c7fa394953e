"""`kurt2rt knowledge merge`."""

from pathlib import Path
from typing import Annotated

import typer

from hal.robot_settings import load_robot
from kurt2rt.cli.knowledge.shared import TEACHER, KnowledgeFile, say
from kurt2rt.cli.options import RobotName, TaskOfTheFile
from kurt2rt.core.task_settings import load_task
from kurt2rt.knowledge.files.task_of_file import task_of_file
from kurt2rt.knowledge.journal.writer import utc_now
from kurt2rt.knowledge.versions.contradictions import load_radii
from kurt2rt.knowledge.versions.merge import Conflict, ConflictCode, MergePlan, Side
from kurt2rt.knowledge.versions.merge import merge as bring_in


def merge(
    file: KnowledgeFile,
    other: Annotated[Path, typer.Argument(help="The file whose lessons are brought in; stays as it is.")],
    prefer: Annotated[
        Side | None, typer.Option(help="Who is right where both changed the same, or say different things.")
    ] = None,
    task_name: TaskOfTheFile = None,
    robot_name: RobotName = "kurt2",
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only tell what would come of it.")] = False,
) -> None:
    """Merge the lessons of OTHER since the files were one; merging again adds nothing.

    Conflicts are listed, and unless --prefer says who is right nothing is
    changed, with exit code 1.

    For example:

        kurt2rt knowledge merge mine.knowledge yours.knowledge --dry-run
        kurt2rt knowledge merge mine.knowledge yours.knowledge --prefer mine
    """
    borders = load_radii(load_task(task_of_file(file, task_name)), load_robot(robot_name))
    merged = bring_in(file, other, borders, prefer, teacher=TEACHER, stamp=utc_now(), dry_run=dry_run)
    for conflict in merged.conflicts:
        say(f"conflict  here {conflict.mine}, there {conflict.theirs}: {reason_of(conflict)}")
    for reward in merged.left_out:
        say(f"left out  {reward}")
    if merged.conflicts and prefer is None:
        say(f"{file}: nothing was changed; say --prefer mine or --prefer theirs")
        raise typer.Exit(1)
    say(f"{file}: {_told(merged)}" + (" (nothing was changed: --dry-run)" if dry_run else ""))


_REASONS = {
    ConflictCode.CHANGED_ON_BOTH_SIDES: "changed on both sides",
    ConflictCode.REWARDED_HERE: "praised or blamed here for what was taken back there",
    ConflictCode.OTHER_SITUATION: "each means another situation, or one means none",
    ConflictCode.NEAR: "{0.distance:.1f} apart, within {percent:.0f} % of R",
}


def reason_of(conflict: Conflict) -> str:
    """Return why the two states exclude each other."""
    return _REASONS[conflict.code].format(conflict, percent=100 * (conflict.radius_fraction or 0.0))


def _told(merged: MergePlan) -> str:
    parts = [f"{merged.lessons} lessons", f"{len(merged.new_ids)} RLAs of them new"] if merged.lessons else []
    parts += [f"{merged.undone} undone"] if merged.undone else []
    parts += [f"{merged.redone} redone"] if merged.redone else []
    return f"brought in: {', '.join(parts)}" if parts else "nothing is there that is not here"
