"""`kurt2rt knowledge compact`."""

from pathlib import Path
from typing import Annotated

import typer

from kurt2rt.cli.knowledge.shared import KnowledgeFile, Recordings, replaying, say
from kurt2rt.knowledge.journal.writer import utc_now
from kurt2rt.knowledge.show.knowledge import TICK_S
from kurt2rt.runs.replay.compaction import TEACHER
from kurt2rt.runs.replay.compaction import compact as delete_unneeded


def compact(
    file: KnowledgeFile,
    recordings: Recordings = Path("var/runs"),
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only tell what would be deleted.")] = False,
) -> None:
    """Delete the RLAs that no recorded decision needs, if a replay proves it.

    All decisions of all runs must be the same without them. Only recorded drives
    count: an RLA for a place where the robot has not driven since recording began
    is deleted, too. Deletions are lessons that can be undone.

    For example:

        kurt2rt knowledge compact var/wall_following.knowledge --dry-run
    """
    with replaying() as report:
        done = delete_unneeded(file, recordings, stamp=utc_now(), dry_run=dry_run, report=report)
    for rla in done.deleted:
        say(f"{'would delete' if dry_run else 'deleted'}: {rla.title}: {rla.action}")
    for behaviour in done.other_behaviours:
        say(f"{behaviour or 'what is taught'} was driven in no run: its RLAs stay")
    for note in done.notes:
        say(f"not tried: {note}")
    driven = f"{done.ticks * TICK_S:.0f} s, {done.driven_ticks * TICK_S:.0f} s of them driven"
    tried = f"tried on {done.ticks} ticks ({driven}) of {done.runs} runs"
    say(f"{file}: {len(done.deleted)} RLAs not needed, {done.kept} kept; {tried}")
    if done.deleted and not dry_run:
        say(f"to take all of that back: kurt2rt knowledge undo {file} --of {TEACHER}")
