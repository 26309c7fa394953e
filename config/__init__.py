"""Data only: robots, worlds, tasks, repertoires, situations, runtime settings and the CAN database.

The code that uses these files has their schemas; `hal.settings` loads them.
"""

from pathlib import Path

CONFIG_DIR = Path(__file__).parent
"""Folder that holds the files shipped with the project."""
