"""Knowledge to be given away, and taken again: all that a file holds, bit for bit, and the settings it needs."""

from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

from hal.robot_settings import RobotSettings
from kurt2rt.core.rla.feature_set import LevelFeatures
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.knowledge.exchange.archive import Archive, pack, unpack
from kurt2rt.knowledge.exchange.attachment_files import unsafe_reason
from kurt2rt.knowledge.exchange.attachments import (
    KNOWLEDGE,
    SETTINGS,
    STATISTICS,
    KnownLesson,
    collect_attachments,
    decode_lessons,
    decode_statistics,
)
from kurt2rt.knowledge.exchange.feature_diff import differing_features
from kurt2rt.knowledge.exchange.manifest import read_manifest
from kurt2rt.knowledge.exchange.signing import fingerprint
from kurt2rt.knowledge.exchange.validation import require_fitting, require_times
from kurt2rt.knowledge.files.atomic_write import SavedCopy, plain_part, stamp_part, write_new, write_numbered
from kurt2rt.knowledge.files.create import create_knowledge
from kurt2rt.knowledge.journal.binding import KnowledgeBinding, require_compatible
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.fold import fold_entries
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import binding_for
from kurt2rt.knowledge.knowledge_error import KnowledgeError

IMPORTED_FROM = "imported from"
"""Name of the note in a knowledge file that was imported."""


@dataclass(frozen=True)
class KnowledgePackage:
    """What is in an exported file."""

    path: Path
    binding: KnowledgeBinding
    lessons: tuple[KnownLesson, ...]
    statistics: Statistics
    task: str
    """Name of the task whose settings are in it."""
    exported_at: str
    """UTC, ISO 8601."""
    signed_by: bytes | None
    """Raw public key of who signed it; the signature fits."""
    settings: Mapping[str, bytes]
    """Settings files in it, by name."""


@dataclass(frozen=True, slots=True)
class ImportResult:
    """What an import has done."""

    given: KnowledgePackage
    other_settings: tuple[str, ...]
    """Settings files that are otherwise here: the same RLAs may have other borders."""


def export_knowledge(
    path: Path,
    out: Path,
    robot: RobotSettings,
    task: TaskSettings,
    key: Ed25519PrivateKey | None,
    *,
    stamp: str,
) -> int:
    """Write what the file at `path` holds to a new file `out`; returns its size in bytes. Raises KnowledgeError.

    `task` and `robot`: those it was taught with; their settings go with it.
    """
    with Journal.read_only(path) as journal:
        content = _package(journal, robot, task, key, stamp)
    write_new(content, out)
    return len(content)


def package_knowledge(path: Path, folder: Path, stamp: str, *, robot: RobotSettings, task: TaskSettings) -> SavedCopy:
    """Save `<task>-<stamp>.zip`, the archive of `export_knowledge`, not signed, while this process writes `path`.

    Waits and raises as `kurt2rt.knowledge.files.copy.save_copy`.
    """
    with Journal.in_writer_process(path) as journal:
        content = _package(journal, robot, task, None, stamp)
        system = journal.binding.system
    return write_numbered(content, folder, (plain_part(system), stamp_part(stamp)), ".zip")


def _package(
    journal: Journal, robot: RobotSettings, task: TaskSettings, key: Ed25519PrivateKey | None, stamp: str
) -> bytes:
    path, binding = journal.path, journal.binding
    require_compatible(binding, binding_for(robot, task), path, journal.has_lessons_at)
    entries, statistics = journal.read_all()
    system = fold_entries(journal, entries, radius=0.0)
    about: dict[str, Any] = {
        "kurt2rt": version("kurt2rt"),
        "exported_at": stamp,
        "task": task.name,
        "system": binding.system,
        "robot": binding.robot,
        "features": _features(LevelFeatures(binding.feature_hash, binding.feature_names)),
        "levels": {level: _features(features) for level, features in binding.levels.items()},
        "rlas": len(system),
        "lessons": system.standing_lessons,
    }
    files = collect_attachments(robot, task, entries, statistics)
    trouble = unsafe_reason({name: len(data) for name, data in files.items()})
    if trouble:  # nobody could take it
        raise KnowledgeError(f"cannot be exported: it {trouble}", where=path, do="name its settings otherwise")
    return pack(about, files, key)


def read_package(path: Path) -> KnowledgePackage:
    """Read an exported file whole. Raises KnowledgeError."""
    archive = unpack(path)
    try:
        return _given(path, archive)
    except KeyError as error:
        raise KnowledgeError(f"has no {error}", where=path, do="export it anew") from error
    except ValueError as error:
        raise KnowledgeError(
            f"cannot be understood ({' '.join(str(error).split())})", where=path, do="export it anew"
        ) from error


def import_knowledge(
    path: Path, into: Path, robot: RobotSettings, task: TaskSettings, trusted: bytes | None, *, stamp: str
) -> ImportResult:
    """Make the knowledge file `into` from an exported one; nothing may be there yet. Raises KnowledgeError.

    `trusted`: raw public key of the only one whose knowledge is taken; None: anybody's, signed or not.
    """
    given = read_package(path)
    if trusted is not None and given.signed_by != trusted:
        by = "by nobody" if given.signed_by is None else f"by {fingerprint(given.signed_by)}"
        raise KnowledgeError(f"is signed {by}, not by {fingerprint(trusted)}", where=path, do="nothing was imported")
    here = binding_for(robot, task)
    if given.binding.feature_hash != here.feature_hash:
        differing = differing_features(given.settings, robot, task) or "in what its settings do not tell"
        raise KnowledgeError(
            f"was taught with other features: {differing}",
            where=path,
            do=("import it with the task and robot settings that it was taught with (--task, --robot-settings)"),
        )
    levels = {getattr(each.event, "level", "") for each in given.lessons}
    levels |= {each.event.rla.level for each in given.lessons if hasattr(each.event, "rla")}
    require_compatible(given.binding, here, path, lambda level: level in levels)
    entries = [JournalEntry(each.event, each.stamped_at) for each in given.lessons]
    note = f"{path.name}, exported {given.exported_at}, imported {stamp}"
    create_knowledge(into, given.binding, entries, given.statistics, {IMPORTED_FROM: note}, source=path)
    return ImportResult(given, _otherwise_here(given, robot, task))


def _otherwise_here(given: KnowledgePackage, robot: RobotSettings, task: TaskSettings) -> tuple[str, ...]:
    here = collect_attachments(robot, task)
    return tuple(name for name, content in given.settings.items() if here.get(name) != content)


def _features(features: LevelFeatures) -> dict[str, Any]:
    return {"hash": features.feature_hash, "names": list(features.feature_names)}


def _given(path: Path, archive: Archive) -> KnowledgePackage:
    """Raises KeyError for a file that is not in it, ValueError."""
    manifest = read_manifest(archive.manifest)
    binding = manifest.binding
    lessons = tuple(decode_lessons(archive.files[KNOWLEDGE]))
    statistics = decode_statistics(archive.files[STATISTICS])
    require_times(lessons)
    require_fitting(statistics, lessons, binding)
    settings = {name: content for name, content in archive.files.items() if name.startswith(SETTINGS)}
    return KnowledgePackage(
        path, binding, lessons, statistics, manifest.task, manifest.exported_at, archive.signed_by, settings
    )
