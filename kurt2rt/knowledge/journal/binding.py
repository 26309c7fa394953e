"""Binding of knowledge: the features it was taught with, and the task."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from kurt2rt.core.rla.condition import LevelFeatures
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError


@dataclass(frozen=True, slots=True)
class KnowledgeBinding:
    """Features and task that a knowledge file is bound to; with others its conditions mean nothing."""

    feature_hash: str
    """Fingerprint of situation definition, sensor order and kind of robot, `SituationDefinition.hash`."""
    feature_names: tuple[str, ...]
    """One per dimension of a condition."""
    system: str
    """Name of the RLA system that was taught: the task's, or one that several tasks share."""
    robot: str
    """Robot that it was first taught on; shown, not compared: the features decide whether another one can use it."""
    levels: Mapping[str, LevelFeatures] = field(default_factory=dict)
    """Features of further levels than the basic one, by the level's name."""


def require_compatible(
    taught: KnowledgeBinding, wanted: KnowledgeBinding, path: Path, has_lessons: Callable[[str], bool]
) -> None:
    """Raise KnowledgeError for knowledge of other features or of another task.

    A level that only one of the two has is no difference: it is added, or left alone. A level without lessons, as
    `has_lessons` tells, is none either: it is bound again.

    Args:
        taught: binding of the knowledge.
        wanted: binding of robot and task.
        path: of the file, for the error.
        has_lessons: whether the file has lessons at a level.
    """
    here = LevelFeatures(wanted.feature_hash, wanted.feature_names)
    there = LevelFeatures(taught.feature_hash, taught.feature_names)
    if there != here:
        difference = _difference(there, here, "the kind of robot, its sensor order, scales or history differ")
        raise KnowledgeError(KnowledgeCode.OTHER_FEATURES, where=path, difference=difference)
    if taught.system != wanted.system:
        raise KnowledgeError(KnowledgeCode.OTHER_TASK, where=path, taught=taught.system, wanted=wanted.system)
    for level, features in wanted.levels.items():
        of_file = taught.levels.get(level, features)
        if of_file != features and has_lessons(level):
            difference = _difference(of_file, features, "what they are made from differs")
            raise KnowledgeError(KnowledgeCode.OTHER_LEVEL_FEATURES, where=path, level=level, difference=difference)


def _difference(taught: LevelFeatures, wanted: LevelFeatures, unseen: str) -> str:
    """Return the difference of two feature sets in words; `unseen` is the text if their names are equal."""
    if taught.feature_names == wanted.feature_names:
        return f"the names are the same, but {unseen}"
    only_taught = [name for name in taught.feature_names if name not in wanted.feature_names]
    only_wanted = [name for name in wanted.feature_names if name not in taught.feature_names]
    if not only_taught and not only_wanted:
        return "the same names in another order or number"
    owners = (("file", only_taught), ("robot", only_wanted))
    return ", ".join(f"only the {owner} has {_few(names)}" for owner, names in owners if names)


def _few(names: list[str], shown: int = 4) -> str:
    more = f" and {len(names) - shown} more" if len(names) > shown else ""
    return ", ".join(repr(name) for name in names[:shown]) + more
