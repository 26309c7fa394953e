"""Export and import of knowledge: all that a file holds, bit for bit, and the settings it needs."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from config.settings import SettingsError
from hal.robot_settings import RobotSettings, robot_of_json
from kurt2rt.core.perception.definition import AVERAGED, SituationDefinition, load_situation
from kurt2rt.core.rla.condition import LevelFeatures
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.knowledge.exchange.archive import Archive, pack, unpack
from kurt2rt.knowledge.exchange.attachment_files import extracted_settings, unsafe_reason
from kurt2rt.knowledge.exchange.attachments import (
    KNOWLEDGE,
    ROBOT,
    SETTINGS,
    STATISTICS,
    TASK,
    collect_attachments,
    decode_lessons,
    decode_statistics,
)
from kurt2rt.knowledge.exchange.manifest import read_manifest, require_expectations, require_times
from kurt2rt.knowledge.files.atomic_write import SavedCopy, plain_part, stamp_part, write_new, write_numbered
from kurt2rt.knowledge.files.create import create_knowledge
from kurt2rt.knowledge.journal.binding import KnowledgeBinding, require_compatible
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.fold import read_content
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import binding_for
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError

IMPORTED_FROM = "imported from"
"""Name of the note in a knowledge file that was imported."""
_MOST_FEATURES_TOLD = 6


@dataclass(frozen=True)
class KnowledgePackage:
    """Content of a file of `kurt2rt knowledge export`: lessons, counts, and the settings of their task.

    `import_knowledge` makes a knowledge file from it, if features and hashes fit.
    """

    path: Path
    binding: KnowledgeBinding
    lessons: tuple[JournalEntry, ...]
    statistics: Statistics
    task: str
    """Name of the task whose settings are in it."""
    exported_at: str
    """UTC, ISO 8601."""
    settings: Mapping[str, bytes]
    """Settings files in it, by name."""


@dataclass(frozen=True, slots=True)
class ImportResult:
    """Result of `import_knowledge`: the package, and the settings that differ here from its own."""

    package: KnowledgePackage
    differing_settings: tuple[str, ...]
    """Settings files that differ here: the same RLAs may answer within other distances."""


def export_knowledge(path: Path, out: Path, robot: RobotSettings, task: TaskSettings, *, stamp: str) -> int:
    """Write a package of the knowledge file at `path` to a new file `out`; return its size in bytes.

    Args:
        path: of the knowledge file.
        out: of the package.
        robot: that it was taught with; its settings are in the package.
        task: that it was taught for; its settings are in the package.
        stamp: of the export, UTC, ISO 8601.

    Raises:
        KnowledgeError: the file does not belong to `task` and `robot`, or one of both files fails.
        SettingsError: a file that the task uses cannot be read.
    """
    with Journal.read_only(path) as journal:
        content = _package(journal, robot, task, stamp)
    write_new(content, out)
    return len(content)


def package_knowledge(path: Path, folder: Path, stamp: str, *, robot: RobotSettings, task: TaskSettings) -> SavedCopy:
    """Save a package of the knowledge file `path` as `<task>-<stamp>.zip` in `folder`.

    This process may be writing `path`. The call waits for the disk. `stamp`: UTC, ISO 8601.

    Raises:
        KnowledgeError: the file does not belong to `task` and `robot`, or one of both files fails.
        SettingsError: a file that the task uses cannot be read.
    """
    with Journal.in_writer_process(path) as journal:
        content = _package(journal, robot, task, stamp)
        system = journal.binding.system
    return write_numbered(content, folder, (plain_part(system), stamp_part(stamp)), ".zip")


def _package(journal: Journal, robot: RobotSettings, task: TaskSettings, stamp: str) -> bytes:
    path, binding = journal.path, journal.binding
    require_compatible(binding, binding_for(robot, task), path, journal.has_lessons_at)
    entries, system, statistics = read_content(journal)
    about: dict[str, Any] = {
        "kurt2rt": version("kurt2rt"),
        "exported_at": stamp,
        "task": task.name,
        "system": binding.system,
        "robot": binding.robot,
        "features": _features(LevelFeatures(binding.feature_hash, binding.feature_names)),
        "levels": {level: _features(features) for level, features in binding.levels.items()},
        "rlas": len(system),
        "lessons": system.history.standing,
    }
    # At the receiver a device of the same name is another person's, so the teachers' delays stay here.
    files = collect_attachments(robot, task, entries, replace(statistics, answer_delays={}))
    reason = unsafe_reason({name: len(data) for name, data in files.items()})
    if reason:  # every import would refuse it
        raise KnowledgeError(KnowledgeCode.NOT_EXPORTABLE, where=path, reason=reason)
    return pack(about, files)


def read_package(path: Path) -> KnowledgePackage:
    """Read and check an exported file. Raises KnowledgeError if it is damaged, changed or of another kind."""
    archive = unpack(path)
    try:
        return _content(path, archive)
    except KeyError as error:
        raise KnowledgeError(KnowledgeCode.PACKAGE_PART_MISSING, where=path, name=error) from error
    except ValueError as error:
        one_line = " ".join(str(error).split())
        raise KnowledgeError(KnowledgeCode.PACKAGE_INVALID, where=path, error=one_line) from error


def import_knowledge(path: Path, into: Path, robot: RobotSettings, task: TaskSettings, *, stamp: str) -> ImportResult:
    """Make the knowledge file `into`, where no file may be, from a package.

    Args:
        path: of the package.
        into: knowledge file to make.
        robot: that will use it.
        task: that it will be used for.
        stamp: of the import, UTC, ISO 8601.

    Raises:
        KnowledgeError: the package is damaged, or of other features or another task.
        SettingsError: a file that `task` uses cannot be read.
    """
    package = read_package(path)
    here = binding_for(robot, task)
    if package.binding.feature_hash != here.feature_hash:
        difference = differing_features(package.settings, robot, task) or "not visible in its settings"
        raise KnowledgeError(KnowledgeCode.PACKAGE_OTHER_FEATURES, where=path, difference=difference)
    levels = {getattr(each.event, "level", "") for each in package.lessons}
    levels |= {each.event.rla.level for each in package.lessons if hasattr(each.event, "rla")}
    require_compatible(package.binding, here, path, lambda level: level in levels)
    note = f"{path.name}, exported {package.exported_at}, imported {stamp}"
    create_knowledge(into, package.binding, package.lessons, package.statistics, {IMPORTED_FROM: note}, source=path)
    return ImportResult(package, _differing_settings(package, robot, task))


def _differing_settings(package: KnowledgePackage, robot: RobotSettings, task: TaskSettings) -> tuple[str, ...]:
    here = collect_attachments(robot, task)
    return tuple(name for name, content in package.settings.items() if here.get(name) != content)


def _features(features: LevelFeatures) -> dict[str, Any]:
    return {"hash": features.feature_hash, "names": list(features.feature_names)}


def _content(path: Path, archive: Archive) -> KnowledgePackage:
    """Return the content of an archive. Raises KeyError for a file that is not in it, ValueError."""
    manifest = read_manifest(archive.manifest)
    binding = manifest.binding
    lessons = tuple(decode_lessons(archive.files[KNOWLEDGE]))
    statistics = decode_statistics(archive.files[STATISTICS])
    require_times(lessons)
    require_expectations(statistics, lessons, binding)
    settings = {name: content for name, content in archive.files.items() if name.startswith(SETTINGS)}
    return KnowledgePackage(
        path,
        binding,
        lessons,
        statistics,
        task=manifest.task,
        exported_at=manifest.exported_at,
        settings=settings,
    )


def differing_features(settings: Mapping[str, bytes], robot: RobotSettings, task: TaskSettings) -> str:
    """Return the differences of the basic situation, there against here, in a few words; empty if there are none.

    Raises config.settings.SettingsError if the situation of `task`, here, cannot be loaded.

    Args:
        settings: files there, as `kurt2rt.knowledge.exchange.attachments` makes them. Unreadable ones count as
            different.
        robot: here.
        task: here.
    """
    try:
        with extracted_settings(settings):
            there_robot = robot_of_json(settings[ROBOT], "the package's robot")
            there_task = TaskSettings.model_validate_json(settings[TASK])
            there = load_situation(there_task.situation, there_robot.infrared.names)
    except (KeyError, ValidationError, SettingsError, OSError) as error:
        return f"its settings cannot be used here ({' '.join(str(error).split())})"
    here = load_situation(task.situation, robot.infrared.names)
    found = list(_differences(there, here))
    if there_robot.infrared.names != robot.infrared.names:
        found.append("the order of the robot's sensors")
    more = f" and {len(found) - _MOST_FEATURES_TOLD} more" if len(found) > _MOST_FEATURES_TOLD else ""
    return ", ".join(found[:_MOST_FEATURES_TOLD]) + more


def _differences(there: SituationDefinition, here: SituationDefinition) -> Iterator[str]:
    known, wanted = ({each.name: each for each in definition.features} for definition in (there, here))
    for name in known:
        if name not in wanted:
            yield f"{name} (only there)"
        elif known[name] != wanted[name]:
            yield f"{name} (made of other sensors)"
    yield from (f"{name} (only here)" for name in wanted if name not in known)
    if known.keys() == wanted.keys() and list(known) != list(wanted):
        yield "their order"
    if there.history_steps != here.history_steps:
        yield f"all{AVERAGED}: over {there.history_steps} steps there, {here.history_steps} here"
    if there.wheel_speed_counts_per_m_s != here.wheel_speed_counts_per_m_s:
        scales = there.wheel_speed_counts_per_m_s, here.wheel_speed_counts_per_m_s
        yield "wheel speeds: {} counts per m/s there, {} here".format(*scales)
    if there.name != here.name:
        yield f"the definition's name: {there.name} there, {here.name} here"
