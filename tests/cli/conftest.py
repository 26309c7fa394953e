import shutil
from pathlib import Path

import pytest

from tests.cli.helpers import CommandLine
from tests.experiments.helpers import short_task, teach


@pytest.fixture
def kurt2rt(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], tmp_path: Path) -> CommandLine:
    """Run the command line in a temporary folder."""
    monkeypatch.chdir(tmp_path)
    return CommandLine(monkeypatch, capfd)


@pytest.fixture(scope="session")
def lessons(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a knowledge file with some lessons; copy it to change it."""
    return teach(tmp_path_factory.mktemp("lessons") / "taught.knowledge", short_task(5.0, 3.0)).knowledge


@pytest.fixture
def mine(lessons: Path, tmp_path: Path) -> Path:
    """Return a copy of the knowledge file, `mine.knowledge` in the temporary folder."""
    return Path(shutil.copy(lessons, tmp_path / "mine.knowledge"))
