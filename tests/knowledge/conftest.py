from pathlib import Path

import pytest


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """Return a path for a new knowledge file."""
    return tmp_path / "knowledge.db"
