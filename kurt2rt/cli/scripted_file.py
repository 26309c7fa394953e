"""The knowledge file that a scripted teacher teaches into: its own, never a person's unless that person agrees."""

import sys
from collections.abc import Sequence
from pathlib import Path

import typer

from config.errors import ExitCode
from kurt2rt.knowledge.journal.loading import read_teachers
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError

_SUFFIX = ".auto"


def own_file(knowledge: Path) -> Path:
    """Return the path of the file that a scripted teacher teaches into, next to the knowledge of people.

    `knowledge`: file of the settings, in which people teach.
    """
    return knowledge.with_name(f"{knowledge.stem}{_SUFFIX}{knowledge.suffix}")


def require_agreement(knowledge: Path) -> None:
    """Ask before a scripted teacher teaches into a file in which people taught.

    Raises typer.Exit if the user says no, KnowledgeError if there is no terminal to ask at or the file cannot be read.
    """
    instead = "leave out --knowledge, then the scripted teacher has a file of its own"
    if knowledge.exists() and not people_agree(str(knowledge), read_teachers(knowledge), instead):
        raise typer.Exit(ExitCode.FAILED)


def people_agree(where: str, people: Sequence[str], instead: str) -> bool:
    """Return whether a scripted teacher may teach where `people` taught; the user is asked where there are some.

    Raises KnowledgeError where there is no terminal to ask at; `instead` is what to do then.
    """
    if not people:
        return True
    taught = f"{where}: {' and '.join(people)} taught in it"
    # Python has no standard input where it was closed.
    if sys.stdin is None or not sys.stdin.isatty():
        raise KnowledgeError(KnowledgeCode.TAUGHT_BY_PEOPLE, where=where, people=" and ".join(people), instead=instead)
    return typer.confirm(f"{taught}. Let the scripted teacher change it?", err=True)
