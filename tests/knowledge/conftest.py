from pathlib import Path

import pytest


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """Where a knowledge file may be begun."""
    return tmp_path / "knowledge.db"
