"""What knowledge is bound to: the features it was taught with, and the task."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from kurt2rt.core.rla.feature_set import LevelFeatures
from kurt2rt.knowledge.knowledge_error import KnowledgeError


@dataclass(frozen=True, slots=True)
class KnowledgeBinding:
    """The world that knowledge belongs to; in another one its conditions mean nothing."""

    feature_hash: str
    """Fingerprint of situation definition and sensor order, `SituationDefinition.hash`."""
    feature_names: tuple[str, ...]
    """One per dimension of a condition."""
    system: str
    """Name of the RLA system that was taught: the task's, or one that several tasks share."""
    robot: str
    """Robot that it was first taught on; told, not compared: the features decide whether another one can use it."""
    levels: Mapping[str, LevelFeatures] = field(default_factory=dict)
    """Features of further levels than the basic one, by the level's name."""


def require_compatible(
    taught: KnowledgeBinding, wanted: KnowledgeBinding, path: Path, has_lessons: Callable[[str], bool]
) -> None:
    """Refuse knowledge of other features or of another task: raises KnowledgeError that names the difference.

    A level that only one of the two has is no difference: it is added, or left alone. Nor is one that was never taught
    anything, as `has_lessons` tells: it is bound anew.
    """
    here = LevelFeatures(wanted.feature_hash, wanted.feature_names)
    there = LevelFeatures(taught.feature_hash, taught.feature_names)
    if there != here:
        difference = _difference(there, here, "scales, history or the robot's sensor order differ")
        raise KnowledgeError(
            f"taught with other features: {difference}",
            where=path,
            do="use the situation definition and robot it was taught with, or give another knowledge file",
        )
    if taught.system != wanted.system:
        raise KnowledgeError(
            f"taught for the task {taught.system!r}, not for {wanted.system!r}",
            where=path,
            do="start that task, or give another knowledge file",
        )
    for level, features in wanted.levels.items():
        of_file = taught.levels.get(level, features)
        if of_file != features and has_lessons(level):
            difference = _difference(of_file, features, "what they are made from differs")
            raise KnowledgeError(
                f"its level {level} was taught with other features: {difference}",
                where=path,
                do=f"use the {level} settings it was taught with, or give another knowledge file",
            )


def _difference(taught: LevelFeatures, wanted: LevelFeatures, unseen: str) -> str:
    """How two that are not the same differ; `unseen`: what it is where the names do not show it."""
    if taught.feature_names == wanted.feature_names:
        return f"the names are the same, but {unseen}"
    only_taught = [name for name in taught.feature_names if name not in wanted.feature_names]
    only_wanted = [name for name in wanted.feature_names if name not in taught.feature_names]
    if not only_taught and not only_wanted:
        return "the same names in another order or number"
    parts = []
    if only_taught:
        parts.append(f"only the file has {_few(only_taught)}")
    if only_wanted:
        parts.append(f"only the robot has {_few(only_wanted)}")
    return ", ".join(parts)


def _few(names: list[str], shown: int = 4) -> str:
    more = f" and {len(names) - shown} more" if len(names) > shown else ""
    return ", ".join(repr(name) for name in names[:shown]) + more
