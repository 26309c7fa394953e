"""Identity of lessons across knowledge files: a lesson is the same in each file that a copy or merge took it to."""

import json
import re
from collections.abc import Mapping
from typing import NamedTuple

from kurt2rt.core.rla.events import Lesson, RlaCreated, SituationNamed
from kurt2rt.core.rla.lesson_history import DERIVED
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.knowledge.journal.event_codec import encode_event

_MERGES = re.compile(rf"(merge-[0-9a-f]{{8}}{DERIVED})*")


class LessonKey(NamedTuple):
    """Key by which a merge knows the same lesson in two files, whatever its ids are there."""

    content: str
    about: str
    """Content of the lesson that created its RLA; empty for a creation and for a name."""


def lesson_keys(system: RlaSystem) -> Mapping[str, LessonKey]:
    """Return the key of each lesson, undone ones included, by command id in this file."""
    keys, created = dict[str, LessonKey](), dict[int, str]()
    for record in system.history.records:
        lesson, about = record.event, ""
        content = _content(lesson)
        if isinstance(lesson, RlaCreated):
            created[lesson.rla.rla_id] = content
        elif not isinstance(lesson, SituationNamed):
            about = created[lesson.rla_id]
        keys[lesson.origin.command_id] = LessonKey(content, about)
    return keys


def first_command_id(command_id: str) -> str:
    """Return the command id that a lesson was taught under, before any merge put its own id before it."""
    return _MERGES.sub("", command_id, count=1)


def _content(lesson: Lesson) -> str:
    """Return the lesson without what differs from file to file."""
    content = json.loads(encode_event(lesson)) | {"command_id": first_command_id(lesson.origin.command_id)}
    for of_its_file in ("version", "rla_id", "credits"):
        content.pop(of_its_file, None)
    return json.dumps(content)
