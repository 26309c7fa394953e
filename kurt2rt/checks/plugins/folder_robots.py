"""Robots that the parts in a folder are for, by the files of tasks and repertoires there."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hal.settings import SettingsError, content_of

_PARTS_OF_A_TASK = ("policy", "judge", "course")


def robots_by_part(folder: Path) -> dict[str, str]:
    """Return the robot, by name or path, of each part that a task or repertoire in the folder names.

    The first file that names a part counts. A file says its robot by `robot`, or lies among a robot's files.
    """
    robots: dict[str, str] = {}
    for path in sorted(folder.rglob("*.yaml")):
        if any(part.startswith(".") for part in path.relative_to(folder).parts):
            continue
        content = _content_or_none(path)
        if isinstance(content, dict) and (robot := _robot_of(content, path)) is not None:
            for part in _parts_of(content):
                robots.setdefault(part, robot)
    return robots


def _content_or_none(path: Path) -> Any:
    try:
        return content_of(path)
    except SettingsError:  # a file of something else; the check of a task tells more
        return None


def _robot_of(content: dict[str, Any], path: Path) -> str | None:
    named = content.get("robot")
    if isinstance(named, str):
        return named
    own = sorted((path.parent.parent / "robots").glob("*.yaml"))
    return str(own[0]) if own else None


def _parts_of(content: dict[str, Any]) -> Iterator[str]:
    actions = content.get("actions")
    for part in (*map(content.get, _PARTS_OF_A_TASK), *(actions if isinstance(actions, list) else ())):
        kind = part.get("kind") if isinstance(part, dict) else None
        if isinstance(kind, str):
            yield kind
