"""Installed distributions that offer plug-ins, made in a folder on Python's path without an installer."""

import sys
from collections.abc import Mapping
from importlib import invalidate_caches
from pathlib import Path

import yaml

from config import CONFIG_DIR


def install(folder: Path, name: str, offered: Mapping[str, Mapping[str, str]], version: str = "1.0") -> None:
    """Put a distribution into a folder, and the folder on Python's path.

    `offered`: `module:Name` by kind, such as policies, and name.
    """
    info = folder / f"{name}-{version}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n", encoding="utf-8")
    lines = [
        line
        for kind, points in offered.items()
        for line in (f"[kurt2rt.{kind}]", *(f"{point} = {target}" for point, target in points.items()))
    ]
    (info / "entry_points.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")
    if str(folder) not in sys.path:
        sys.path.append(str(folder))
    invalidate_caches()


def write_parts(folder: Path, module: str) -> None:
    """Write the parts of tests/plugin_parts.py to a module of a folder."""
    (folder / f"{module}.py").write_bytes(Path(__file__).with_name("plugin_parts.py").read_bytes())


def write_task(folder: Path, **sections: object) -> Path:
    """Write wall following with other sections, such as policy, to mine.yaml of a folder; return its path."""
    content = yaml.safe_load((CONFIG_DIR / "tasks" / "wall_following.yaml").read_text(encoding="utf-8"))
    content.update(sections)
    path = folder / "mine.yaml"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    return path


def write_repertoire(folder: Path, *actions: Mapping[str, object]) -> Path:
    """Write the basic repertoire with further actions to actions.yaml of a folder; return its path."""
    content = yaml.safe_load((CONFIG_DIR / "repertoires" / "basic.yaml").read_text(encoding="utf-8"))
    content["actions"] += actions
    path = folder / "actions.yaml"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    return path
