"""`kurt2rt knowledge check`."""

import typer

from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.knowledge.shared import KnowledgeFile
from kurt2rt.knowledge.journal.fold import check_knowledge
from kurt2rt.knowledge.journal.journal import Journal


def check(file: KnowledgeFile, as_json: AsJson = False) -> None:
    """Check that every lesson in the file can be read and fits; exit code 1 if one does not.

    For example:

        kurt2rt knowledge check var/wall_following.knowledge
    """
    with Journal.read_only(file) as journal:
        faults = check_knowledge(journal)
    if as_json:
        print_json({"file": file, "sound": not faults, "faults": faults})
    else:
        for line in faults or [f"{file}: every lesson can be read and fits"]:
            typer.echo(line)
    if faults:
        raise typer.Exit(1)
