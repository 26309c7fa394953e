"""`kurt2rt knowledge export`, `import`, `key` and `table`."""

from pathlib import Path
from typing import Annotated

import typer

from hal.robot_settings import load_robot_of
from kurt2rt.cli.json_output import AsJson, print_json
from kurt2rt.cli.knowledge.shared import KnowledgeFile, say
from kurt2rt.cli.options import RobotName, TaskOfTheFile, task_option
from kurt2rt.core.task_settings import load_task
from kurt2rt.knowledge.exchange.package import export_knowledge, import_knowledge, read_package
from kurt2rt.knowledge.exchange.signing import fingerprint, make_key, read_private_key, read_public_key
from kurt2rt.knowledge.files.table import export_table
from kurt2rt.knowledge.files.task_of_file import task_of_elsewhere, task_of_file
from kurt2rt.knowledge.journal import journal_file
from kurt2rt.knowledge.journal.writer import utc_now


def export(
    file: KnowledgeFile,
    out: Annotated[Path, typer.Argument(help="File to write; nothing may be there yet.")],
    sign: Annotated[
        Path | None, typer.Option(help="Sign it with this private key, as kurt2rt knowledge key makes one.")
    ] = None,
    task_name: TaskOfTheFile = None,
    robot_name: RobotName = None,
) -> None:
    """Write one file to give away: all lessons and counts, and the settings of their task.

    For example:

        kurt2rt knowledge export var/wall_following.knowledge walls.zip
        kurt2rt knowledge export var/wall_following.knowledge walls.zip --sign ann
    """
    key = None if sign is None else read_private_key(sign)
    name = task_of_file(file, task_name)
    robot, task = load_robot_of(robot_name, name), load_task(name)
    size = export_knowledge(file, out, robot, task, key, stamp=utc_now())
    signed = "" if key is None else f", signed by {fingerprint(key.public_key().public_bytes_raw())}"
    say(f"export  {out}: {size / 1000:.0f} kB{signed}")


def import_(
    file: Annotated[Path, typer.Argument(help="File that kurt2rt knowledge export wrote.")],
    into: Annotated[Path, typer.Option(help="Knowledge file to make; nothing may be there yet.")],
    task_name: Annotated[str | None, task_option("Default: the task whose settings came with it.")] = None,
    robot_name: RobotName = None,
    trusted: Annotated[
        Path | None, typer.Option(help="Take it only if the owner of this public key (.pub) has signed it.")
    ] = None,
) -> None:
    """Make a knowledge file of an exported one; refuse what was changed, or has other features.

    For example:

        kurt2rt knowledge import walls.zip --into var/walls.knowledge
        kurt2rt knowledge import walls.zip --into walls.knowledge --trusted ann.pub
    """
    public = None if trusted is None else read_public_key(trusted)
    named = read_package(file, public).task
    name = task_name or task_of_elsewhere(named, file)
    robot, task = load_robot_of(robot_name, name), load_task(name)
    imported = import_knowledge(file, into, robot, task, public, stamp=utc_now())
    package = imported.package
    signer = "not signed" if package.signed_by is None else f"signed by {fingerprint(package.signed_by)}"
    vouched = "" if package.signed_by is None or public is not None else ", a signer that was not checked (--trusted)"
    say(f"import  {into}: {len(package.lessons)} rows of {package.binding.system}, {signer}{vouched}")
    if imported.differing_settings:
        say(f"settings that differ here: {', '.join(imported.differing_settings)}")


def key(
    file: Annotated[Path, typer.Argument(help="Where the private key goes; nothing may be there yet.")],
) -> None:
    """Make a key to sign exports with, and its public half (.pub) for those who are to trust it.

    For example:

        kurt2rt knowledge key ann
    """
    public = make_key(file)
    say(f"key  {file}: keep it to yourself")
    say(f"public key  {public}: {fingerprint(read_public_key(public))}")


def table(
    file: KnowledgeFile,
    out: Annotated[Path, typer.Option(help="Folder for the table; made where it is missing.")] = Path("results/export"),
    as_json: AsJson = False,
) -> None:
    """Write the RLAs as a table (CSV): one row each, with condition, teacher and use.

    Numbers are exact. A text that a spreadsheet would run as a formula gets an
    apostrophe before it.

    For example:

        kurt2rt knowledge table var/wall_following.knowledge --out results/export
    """
    journal_file.require_ours(file)
    saved = export_table(file, out, utc_now())
    if as_json:
        print_json({"table": out / saved.name, "sha256": saved.sha256})
        return
    say(f"table  {out / saved.name}")
    say(f"sha256  {saved.sha256}")
