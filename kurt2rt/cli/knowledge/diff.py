"""`kurt2rt knowledge diff`."""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

import typer

from kurt2rt.cli.json_output import AsJson
from kurt2rt.cli.knowledge.shared import KnowledgeFile, say
from kurt2rt.core.rla.lesson_history import LessonRecord
from kurt2rt.core.rla.rla import Rla
from kurt2rt.knowledge.journal.binding import require_compatible
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.versions.diff import KnowledgeDiff, compare


def diff(
    file: KnowledgeFile,
    other: Annotated[Path, typer.Argument(help="Another knowledge file of the same features.")],
    as_json: AsJson = False,
) -> None:
    """Compare two files: lessons and RLAs that only one has, RLAs with another action.

    For example:

        kurt2rt knowledge diff mine.knowledge yours.knowledge
    """
    with Journal.read_only(file) as a, Journal.read_only(other) as b:
        require_compatible(b.binding, a.binding, other, b.has_lessons_at)
        found = compare(a, b)
    if as_json:
        typer.echo(json.dumps(_as_json(found), indent=2))
        return
    for line in _lines(found, str(file), str(other)):
        say(line)


def _lines(found: KnowledgeDiff, a: str, b: str) -> Iterable[str]:
    yield f"both begin with the same {found.common_rows} rows"
    if found.is_empty:
        yield "and know the same"
    for path, lessons in ((a, found.lessons_a), (b, found.lessons_b)):
        if lessons:
            yield f"{len(lessons)} lessons stand only in {path}:"
            yield from (f"  {record.text} ({record.event.origin.teacher})" for record in lessons)
    for path, rlas in ((a, found.rlas_a), (b, found.rlas_b)):
        if rlas:
            yield f"{len(rlas)} RLAs live only in {path}:"
            yield from (f"  {rla.title}: {rla.action}" for rla in rlas)
    if found.changed:
        yield f"{len(found.changed)} RLAs have another action in {b} than in {a}:"
        yield from (f"  {here.title}: {there.action} instead of {here.action}" for here, there in found.changed)


def _as_json(found: KnowledgeDiff) -> dict[str, Any]:
    return {
        "common_rows": found.common_rows,
        "lessons_only_here": [_lesson(record) for record in found.lessons_a],
        "lessons_only_there": [_lesson(record) for record in found.lessons_b],
        "rlas_only_here": [_rla(rla) for rla in found.rlas_a],
        "rlas_only_there": [_rla(rla) for rla in found.rlas_b],
        "rlas_with_another_action": [{"here": _rla(here), "there": _rla(there)} for here, there in found.changed],
    }


def _lesson(record: LessonRecord) -> dict[str, Any]:
    origin = record.event.origin
    return {"id": origin.command_id, "teacher": origin.teacher, "lesson": record.text}


def _rla(rla: Rla) -> dict[str, Any]:
    return {"rla": rla.rla_id, "level": rla.level, "behaviour": rla.behaviour, "action": rla.action}
