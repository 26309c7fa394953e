"""Attachments of a run or package: its settings and the knowledge at its start, as files that a replay needs."""

import base64
import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ValidationError

from behaviors.repertoire_settings import RepertoireSettings, TaskAction, TaughtAction
from config.settings import Settings, load_settings
from config.settings_files import FILES, find_beside, find_config, kept_name
from hal.robot_settings import RobotSettings
from kurt2rt.core.message_fields import Real, check_of, wire_error
from kurt2rt.core.rla.statistics import Expectation, Statistics
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.event_codec import Id, Number, StoredText, decode_event, encode_event
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_error import KnowledgeError

ROBOT, TASK = "settings/robot.json", "settings/task.json"
"""Settings as they were in force, from files and options."""
KNOWLEDGE, STATISTICS = "knowledge.jsonl", "statistics.json"
SETTINGS = "settings/"
"""Prefix of the files that loaders of settings look for."""
_TEXT = check_of(StoredText)
_ABSENT = (None, [""])
"""Values of a key that was left out: nothing, and the one behaviour without a name."""


def collect_attachments(
    robot: RobotSettings,
    task: TaskSettings,
    entries: Iterable[JournalEntry] = (),
    saved: Statistics | None = None,
) -> dict[str, bytes]:
    """Return all attachments of a run by name; call it before the first tick.

    Args:
        robot: settings in force.
        task: settings in force.
        entries: lessons that the run begins with.
        saved: statistics that the run begins with; None: no attachment of them.

    Raises:
        SettingsError: a file that the task uses cannot be read.
        KnowledgeError: a knowledge file that an action of the task uses cannot be read.
    """
    attached = {
        ROBOT: _in_force(robot),
        TASK: _in_force(task),
        KNOWLEDGE: _encode_lessons(entries),
    }
    if saved is not None:
        attached[STATISTICS] = encode_statistics(saved)
    for kind, name, data in _used_by(task, set()):
        attached[f"{SETTINGS}{kind}/{kept_name(name)}"] = data
    return attached


def hash_attachments(attached: Mapping[str, bytes]) -> dict[str, str]:
    """Return the SHA-256 of each attachment, hexadecimal."""
    return {name: hashlib.sha256(data).hexdigest() for name, data in attached.items()}


def decode_lessons(data: bytes) -> list[JournalEntry]:
    """Return the lessons in `knowledge.jsonl`. Raises ValueError, which names that file."""
    lessons = []
    try:
        for number, line in enumerate(data.decode().splitlines(), start=1):
            content = json.loads(line)
            event = decode_event(json.dumps(content["event"]), f"{KNOWLEDGE}: line {number}")
            lessons.append(JournalEntry(event, _TEXT("stamped_at", content["stamped_at"])))
    except (KnowledgeError, ValueError, KeyError, TypeError, RecursionError) as error:
        raise ValueError(f"{KNOWLEDGE} cannot be read: {error}") from error
    return lessons


def encode_statistics(statistics: Statistics) -> bytes:
    """Return the statistics as JSON, exact to the last bit."""
    return json.dumps(
        {
            "uses": list(statistics.uses.items()),
            "transitions": [[*key, value] for key, value in statistics.transitions.items()],
            "values": list(statistics.values.items()),
            "numbers": dict(statistics.numbers),
            "expectations": [
                [rla_id, each.lesson, each.count, each.ticks, _text(each.packed_mean), _text(each.packed_squares)]
                for rla_id, each in statistics.expectations.items()
            ],
            "answer_delays": dict(statistics.answer_delays),
        }
    ).encode()


def _unpacked(text: object) -> bytes:
    return base64.b64decode(_TEXT("base64", text), validate=True)


_Packed = Annotated[bytes, BeforeValidator(_unpacked)]


class _Saved(BaseModel):
    """Statistics as rows."""

    uses: tuple[tuple[Number, Number], ...]
    transitions: tuple[tuple[Number, Number, Number], ...]
    values: tuple[tuple[Number, Real], ...]
    numbers: dict[StoredText, Real]
    expectations: tuple[tuple[Number, StoredText, Id, Real, _Packed, _Packed], ...]
    answer_delays: dict[StoredText, tuple[Number, ...]]


def decode_statistics(data: bytes) -> Statistics:
    """Return the statistics in the JSON of `encode_statistics`. Raises ValueError, which names the file."""
    try:
        saved = _Saved.model_validate(json.loads(data))
    except ValidationError as error:
        raise ValueError(f"{STATISTICS} cannot be read: {wire_error('its content', error)}") from error
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{STATISTICS} cannot be read: {type(error).__name__}: {error}") from error
    return Statistics(
        dict(saved.uses),
        {(before, after): count for before, after, count in saved.transitions},
        dict(saved.values),
        saved.numbers,
        {
            rla_id: Expectation(lesson, count, ticks, mean, squares)
            for rla_id, lesson, count, ticks, mean, squares in saved.expectations
        },
        saved.answer_delays,
    )


def _encode_lessons(entries: Iterable[JournalEntry]) -> bytes:
    """Encode lesson by lesson: a list of all lines before they are joined would be a run's peak of memory."""
    lines = bytearray()
    for each in entries:
        line = json.dumps({"stamped_at": each.stamped_at, "event": json.loads(encode_event(each.event))})
        lines += line.encode() + b"\n"
    return bytes(lines)


def _in_force(settings: Settings) -> bytes:
    """Return settings as JSON, with all defaults: another kurt2rt may have other defaults."""
    every = settings.model_dump(mode="json", serialize_as_any=True)
    given = settings.model_dump(mode="json", serialize_as_any=True, exclude_unset=True)
    return json.dumps(_without_absent(every, given)).encode()


def _without_absent(every: Any, given: Any) -> Any:
    """Return `every` value except absent ones that are not `given`: files leave such a key out."""
    match every:
        case dict():
            keys = given if isinstance(given, dict) else {}
            return {
                key: _without_absent(value, keys.get(key))
                for key, value in every.items()
                if key in keys or value not in _ABSENT
            }
        case list():
            parts = given if isinstance(given, list) else [None] * len(every)
            return [_without_absent(*each) for each in zip(every, parts, strict=True)]
    return every


def _used_by(task: TaskSettings, seen: set[tuple[str, str]]) -> Iterator[tuple[str, str, bytes]]:
    """Yield kind, name and content of every file that the runtime of a task reads."""
    named: list[tuple[str, object]] = [("situations", task.situation), ("repertoires", task.repertoire)]
    named += [("critics", task.critic), ("mid_levels", task.mid)]
    for kind, name in named:
        if not isinstance(name, str) or (kind, name) in seen:  # settings within the task are in its own file
            continue
        seen.add((kind, name))
        path = find_config(kind, name)
        yield kind, name, path.read_bytes()
        if kind == "repertoires":
            yield from _used_by_actions(path, seen)


def _used_by_actions(repertoire: Path, seen: set[tuple[str, str]]) -> Iterator[tuple[str, str, bytes]]:
    """Yield the same for the actions of a repertoire that were taught, and their knowledge files."""
    for action in load_settings(repertoire, RepertoireSettings).actions:
        if isinstance(action, TaughtAction | TaskAction):
            yield "tasks", action.task, find_config("tasks", action.task).read_bytes()
            yield from _used_by(load_task(action.task), seen)
            with Journal.in_writer_process(find_beside(repertoire.resolve(), action.knowledge)) as journal:
                yield FILES, action.knowledge, journal.image()


def _text(packed: bytes) -> str:
    return base64.b64encode(packed).decode()
