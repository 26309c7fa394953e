"""`kurt2rt knowledge branch` and `merge`."""

from pathlib import Path
from typing import Annotated

import typer

from hal.errors import ExitCode
from hal.robot_settings import load_robot_of
from kurt2rt.cli.knowledge.shared import TEACHER, KnowledgeFile, say
from kurt2rt.cli.options import RobotName, TaskOfTheFile
from kurt2rt.core.rla.rla import rla_title
from kurt2rt.core.task_settings import load_task
from kurt2rt.knowledge.files.task_of_file import task_of_file
from kurt2rt.knowledge.journal.writer import utc_now
from kurt2rt.knowledge.versions.branch import branch as make_branch
from kurt2rt.knowledge.versions.contradictions import load_radii
from kurt2rt.knowledge.versions.merge import Conflict, ConflictCode, MergePlan, NameState, RlaState, Side
from kurt2rt.knowledge.versions.merge import merge as merge_files
from kurt2rt.knowledge.versions.merge_writer import LeftOutCode, LeftOutReward


def branch(
    file: KnowledgeFile,
    new: Annotated[Path, typer.Argument(help="The file to make; nothing may be there yet.")],
    at: Annotated[
        str | None,
        typer.Option(help="Last lesson that comes with it, by its id, or a time (ISO 8601, UTC as +00:00); else all."),
    ] = None,
) -> None:
    """Make a new file that begins as FILE was; its lessons can be merged back.

    For example:

        kurt2rt knowledge branch var/streets.knowledge try.knowledge
        kurt2rt knowledge branch mine.knowledge try.knowledge --at LESSON-ID
    """
    made = make_branch(file, new, at, stamp=utc_now())
    say(f"branch  {new}: the first {made.origin.rows} rows of {made.origin.file}")
    if made.skipped_earlier:
        say(
            f"{made.skipped_earlier} later rows bear dates before that, too: the clock was set back meanwhile. "
            "They are not in it; --at with the id of a lesson says how far to go"
        )


def merge(
    file: KnowledgeFile,
    other: Annotated[Path, typer.Argument(help="The file whose lessons are brought in; stays as it is.")],
    prefer: Annotated[
        Side | None, typer.Option(help="The file that is right if both changed an RLA, or contradict each other.")
    ] = None,
    task_name: TaskOfTheFile = None,
    robot_name: RobotName = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only tell what would come of it.")] = False,
) -> None:
    """Merge OTHER's lessons into FILE; merging again adds nothing.

    Conflicts are listed. Unless --prefer names a side, nothing is changed
    then, with exit code 1.

    For example:

        kurt2rt knowledge merge mine.knowledge yours.knowledge --dry-run
        kurt2rt knowledge merge mine.knowledge yours.knowledge --prefer mine
    """
    name = task_of_file(file, task_name)
    radii = load_radii(load_task(name), load_robot_of(robot_name, name))
    merged = merge_files(file, other, radii, prefer, teacher=TEACHER, stamp=utc_now(), dry_run=dry_run)
    for conflict in merged.conflicts:
        states = f"here {format_state(conflict.mine)}, there {format_state(conflict.theirs)}"
        say(f"conflict  {states}: {format_reason(conflict)}")
    for reward in merged.left_out:
        say(f"left out  {format_left_out(reward)}")
    if merged.conflicts and prefer is None:
        say(f"{file}: nothing was changed; say --prefer mine or --prefer theirs")
        raise typer.Exit(ExitCode.FAILED)
    say(f"{file}: {_format_plan(merged)}" + (" (nothing was changed: --dry-run)" if dry_run else ""))


_REASONS = {
    ConflictCode.CHANGED_ON_BOTH_SIDES: "changed on both sides",
    ConflictCode.REWARDED_HERE: "rewarded here for a lesson that was undone there",
    ConflictCode.OTHER_SITUATION: "the name means another situation, or none",
    ConflictCode.NEAR: "{0.distance:.1f} apart, within {percent:.0f} % of R",
}

_LEFT_OUT = {
    LeftOutCode.RLA_GONE: "{lesson} there by {teacher} for {action}; the RLA is gone here",
    LeftOutCode.OTHER_ACTION: "{lesson} there by {teacher} for {action}; it is {state} here",
    LeftOutCode.BURIED: "{lesson} by {teacher} was undone there, and stays under lessons taught here since",
}


def format_reason(conflict: Conflict) -> str:
    """Return the reason that both states of a conflict exclude each other."""
    return _REASONS[conflict.code].format(conflict, percent=100 * (conflict.radius_fraction or 0.0))


def format_state(state: RlaState | NameState) -> str:
    """Return the action of an RLA, or whether a name is given, in one of the files."""
    if isinstance(state, NameState):
        return f"the name {state.name} is {'given' if state.given else 'not given'}"
    if state.rla is not None:
        return f"{state.rla.title} {'asks' if state.rla.is_withdrawn else f'says {state.rla.action}'}"
    return "it was left out before" if state.rla_id is None else f"{rla_title(state.rla_id, '')} is gone"


def format_left_out(reward: LeftOutReward) -> str:
    """Return a line with the reward that was left out, and the reason."""
    state = "" if reward.rla is None else f"{reward.rla.title} with {reward.rla.action}"
    return _LEFT_OUT[reward.code].format(
        lesson=reward.record.text, teacher=reward.record.event.origin.teacher, action=reward.action, state=state
    )


def _format_plan(merged: MergePlan) -> str:
    parts = [f"{merged.lessons} lessons", f"{len(merged.new_ids)} RLAs of them new"] if merged.lessons else []
    parts += [f"{merged.undone} undone"] if merged.undone else []
    parts += [f"{merged.redone} redone"] if merged.redone else []
    return f"brought in: {', '.join(parts)}" if parts else "nothing is there that is not here"
