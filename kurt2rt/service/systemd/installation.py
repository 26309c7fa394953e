"""Start command and paths of this installation of kurt2rt."""

import sys
from pathlib import Path

from hal.settings_files import SHIPPED_DIR


def start_command() -> tuple[str, ...]:
    """Return the words that start kurt2rt, with absolute paths."""
    script = Path(sys.executable).with_name("kurt2rt")
    if script.is_file():
        return (str(script),)
    # Without -P the present folder, which may be the service's own state, would be searched for modules.
    return (sys.executable, "-P", "-m", "kurt2rt.cli.main")


def required_paths() -> tuple[Path, ...]:
    """Return the files and folders that kurt2rt needs."""
    return (Path(start_command()[0]), Path(sys.prefix), Path(sys.base_prefix), SHIPPED_DIR)
