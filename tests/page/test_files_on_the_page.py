"""Copies of the knowledge that the page offers as downloads."""

from pathlib import Path

import pytest

from tests.page.fake_robot import FakeRobot
from tests.page.lesson import Lesson
from tests.page.phone import PORTRAIT, SMALL
from tests.page.test_served_page import served

NAME, CONTENT = "wall-following-20261122T180000.zip", bytes(range(256)) * 20


@pytest.fixture
def lesson(a_lesson: Lesson) -> Lesson:
    def prepare(robot: FakeRobot) -> None:
        robot.files[NAME] = CONTENT
        robot.answers_with = {"name": NAME, "sha256": "ab" * 32, "size": len(CONTENT)}

    a_lesson.begin(prepare)
    a_lesson.phone.turn(PORTRAIT)
    a_lesson.phone.touch("#tab-more")
    return a_lesson


@pytest.mark.parametrize(("button", "order"), [("#export", ("export", "package")), ("#save", ("save", ""))])
def test_a_copy_is_downloaded_whole(lesson: Lesson, tmp_path: Path, button: str, order: tuple[str, str]) -> None:
    phone = lesson.phone
    phone.driver.execute_cdp_cmd(
        "Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": str(tmp_path), "eventsEnabled": False}
    )
    phone.touch(button)
    phone.wait((tmp_path / NAME).exists, "the browser has stored it")
    assert (tmp_path / NAME).read_bytes() == CONTENT
    assert order in lesson.robot.told
    assert phone.text("#saved") == f"Downloaded: {NAME} (5 kB); a copy is on the robot."
    for size in (PORTRAIT, SMALL):
        phone.turn(size)
        phone.show(f"20-downloaded-{size[0]}x{size[1]}")


async def test_a_download_needs_the_cookie_and_a_file_of_the_robot() -> None:
    async with served() as page:
        page.robot.files[NAME] = CONTENT
        assert (await page.get(f"/files/{NAME}")).status == 403
        got = await page.get(f"/files/{NAME}", page.cookie)
        assert (got.status, got.content) == (200, CONTENT)
        assert got.headers["Content-Disposition"] == f"attachment; filename*=UTF-8''{NAME}"
        missing = await page.get("/files/robot.key", page.cookie)
        assert missing.status == 404
        assert "save or export again" in missing.body
        page.robot.silent = True
        assert (await page.get(f"/files/{NAME}", page.cookie)).status == 504
