"""Data only: robots, worlds, tasks, repertoires, situations, runtime settings and the CAN database.

The schemas that check these files stand beside the code that uses them; `hal.settings` loads them.
"""

from pathlib import Path

CONFIG_DIR = Path(__file__).parent
"""Folder that holds the files shipped with the project."""
