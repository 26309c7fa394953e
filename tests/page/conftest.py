import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.page.classroom import Classroom, classroom
from tests.page.phone import Phone, phone


@pytest.fixture(scope="module")
def a_phone() -> Iterator[Phone]:
    """One browser for all stories of a file."""
    folder = os.environ.get("KURT2RT_SCREENSHOTS")
    with phone(Path(folder) if folder else None) as opened:
        yield opened


@pytest.fixture(scope="module")
def room(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Classroom]:
    """One robot for all stories of a file."""
    with classroom(tmp_path_factory.mktemp("classroom")) as opened:
        yield opened
