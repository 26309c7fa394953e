"""Settings of robots, worlds, tasks and the runtime, their loader, the shelf of plug-ins, and errors that users see.

The YAML files stand next to the modules; the code that uses a file has its schema.
"""

from pathlib import Path

CONFIG_DIR = Path(__file__).parent
"""Folder that holds the files shipped with the project."""
