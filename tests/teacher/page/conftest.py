import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.teacher.page.classroom import Classroom, classroom
from tests.teacher.page.lesson import Lesson, lessons
from tests.teacher.page.phone import Phone, phone


@pytest.fixture(scope="session")
def the_browser() -> Iterator[Phone]:
    """Return one browser for all tests, because its start takes longer than most of them."""
    folder = os.environ.get("KURT2RT_SCREENSHOTS")
    with phone(Path(folder) if folder else None) as opened:
        yield opened


@pytest.fixture
def a_phone(the_browser: Phone, request: pytest.FixtureRequest) -> Iterator[Phone]:
    """Return the phone, on the page of the test before unless that one failed."""
    failed = request.session.testsfailed
    yield the_browser
    if request.session.testsfailed > failed:
        the_browser.leave()


@pytest.fixture(scope="package")
def room(tmp_path_factory: pytest.TempPathFactory, the_browser: Phone) -> Iterator[Classroom]:
    """One robot for all tests."""
    with classroom(tmp_path_factory.mktemp("classroom"), the_browser) as opened:
        yield opened


@pytest.fixture(scope="package")
def the_lessons(the_browser: Phone) -> Iterator[Lesson]:
    """One page and its server for all tests, because to load it takes longer than most of them."""
    with lessons(the_browser) as opened:
        yield opened


@pytest.fixture
def a_lesson(a_phone: Phone, the_lessons: Lesson) -> Lesson:
    """Return the lesson before its begin."""
    assert the_lessons.phone is a_phone
    return the_lessons
