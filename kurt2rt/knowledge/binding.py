"""What knowledge is bound to: the features it was taught with, and the task."""

from dataclasses import dataclass
from pathlib import Path

from kurt2rt.knowledge.error import KnowledgeError


@dataclass(frozen=True, slots=True)
class KnowledgeBinding:
    """The world that knowledge belongs to; in another one its conditions mean nothing."""

    feature_hash: str
    """Fingerprint of situation definition and sensor order, `SituationDefinition.hash`."""
    feature_names: tuple[str, ...]
    """One per dimension of a condition."""
    system: str
    """Name of the task that the RLA system was taught for."""
    robot: str
    """Robot that it was first taught on; told, not compared: the features decide whether another one can use it."""


def require_same(taught: KnowledgeBinding, wanted: KnowledgeBinding, path: Path) -> None:
    """Refuse knowledge of other features or of another task: raises KnowledgeError that names the difference."""
    if taught.feature_hash != wanted.feature_hash or taught.feature_names != wanted.feature_names:
        raise KnowledgeError(
            f"{path}: taught with other features: {_difference(taught, wanted)}; "
            "use the situation definition and robot it was taught with, or give another knowledge file"
        )
    if taught.system != wanted.system:
        raise KnowledgeError(
            f"{path}: taught for the task {taught.system!r}, not for {wanted.system!r}; "
            "start that task, or give another knowledge file"
        )


def _difference(taught: KnowledgeBinding, wanted: KnowledgeBinding) -> str:
    if taught.feature_names == wanted.feature_names:
        return "the names are the same, but scales, history or the robot's sensor order differ"
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
