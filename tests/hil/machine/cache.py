"""Folder of what is built once for the machine."""

import os
from pathlib import Path


def cache_folder() -> Path:
    """Make the folder, unless it is there, and return it. Raises OSError."""
    folder = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "kurt2rt"
    folder.mkdir(parents=True, exist_ok=True)
    return folder
