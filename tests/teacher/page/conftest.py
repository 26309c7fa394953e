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


@pytest.fixture(scope="module")
def phone_of_this_file(the_browser: Phone) -> Iterator[Phone]:
    """Return the phone without data of the file before."""
    the_browser.forget()
    yield the_browser
    the_browser.leave()


@pytest.fixture
def a_phone(phone_of_this_file: Phone, request: pytest.FixtureRequest) -> Iterator[Phone]:
    """Return the phone, on the page of the test before unless that one failed."""
    failed = request.session.testsfailed
    yield phone_of_this_file
    if request.session.testsfailed > failed:
        phone_of_this_file.leave()


@pytest.fixture(scope="module")
def room(tmp_path_factory: pytest.TempPathFactory, phone_of_this_file: Phone) -> Iterator[Classroom]:
    """One robot for all tests of a file."""
    with classroom(tmp_path_factory.mktemp("classroom"), phone_of_this_file) as opened:
        yield opened


@pytest.fixture(scope="module")
def lessons_of_this_file(phone_of_this_file: Phone) -> Iterator[Lesson]:
    """One page and its server for all tests of a file."""
    with lessons(phone_of_this_file) as opened:
        yield opened


@pytest.fixture
def a_lesson(a_phone: Phone, lessons_of_this_file: Lesson) -> Lesson:
    """Return the lesson before its begin."""
    assert lessons_of_this_file.phone is a_phone
    return lessons_of_this_file
