"""A figure in a file."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True)
class SavedFigure:
    """A PNG, and what it shows."""

    path: Path
    title: str
    caption: str
