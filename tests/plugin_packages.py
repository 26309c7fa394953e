"""Installed distributions that offer plug-ins, made in a folder on Python's path without an installer."""

import sys
from collections.abc import Mapping
from importlib import invalidate_caches
from pathlib import Path


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
