import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.page.classroom import Classroom, classroom
from tests.page.phone import Phone, phone


@pytest.fixture(scope="session")
def the_phone() -> Iterator[Phone]:
    """One browser for all stories: to start it takes longer than most of them."""
    folder = os.environ.get("KURT2RT_SCREENSHOTS")
    with phone(Path(folder) if folder else None) as opened:
        yield opened


@pytest.fixture(scope="module")
def a_phone(the_phone: Phone) -> Iterator[Phone]:
    """It knows nothing of the file before."""
    the_phone.forget()
    yield the_phone
    the_phone.open("about:blank")


@pytest.fixture(scope="module")
def room(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Classroom]:
    """One robot for all stories of a file."""
    with classroom(tmp_path_factory.mktemp("classroom")) as opened:
        yield opened
