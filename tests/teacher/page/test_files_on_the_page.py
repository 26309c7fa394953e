"""Copies of the knowledge that the page offers as downloads."""

import hashlib
import json
from pathlib import Path

import pytest

from kurt2rt.channel.protocol.limits import MOST_UPLOAD_BYTES
from tests.teacher.page.fake_robot import FakeRobot
from tests.teacher.page.lesson import Lesson
from tests.teacher.page.phone import PORTRAIT
from tests.teacher.page.test_served_page import served

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


def test_a_copy_is_downloaded_whole(lesson: Lesson, tmp_path: Path) -> None:
    phone = lesson.phone
    phone.driver.execute_cdp_cmd(
        "Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": str(tmp_path), "eventsEnabled": False}
    )
    phone.touch("#export")
    phone.wait((tmp_path / NAME).exists, "the browser has stored it")
    assert (tmp_path / NAME).read_bytes() == CONTENT
    assert ("/export", "package") in lesson.robot.told
    assert f"{NAME} (5 kB)" in phone.text("#saved")


def test_a_file_is_uploaded_and_loaded(lesson: Lesson, tmp_path: Path) -> None:
    phone, file = lesson.phone, tmp_path / NAME
    file.write_bytes(CONTENT)
    phone.write("#load-file", str(file))
    lesson.reads("#said", "load done")
    (uploaded,) = (each for each in lesson.robot.told if each[0] == "upload")
    (loaded,) = (each for each in lesson.robot.told if each[0] == "/load")
    assert uploaded[2] == CONTENT
    assert loaded[1:] == (uploaded[1], hashlib.sha256(CONTENT).digest())
    phone.show("24-loaded")


def test_a_file_that_the_robot_refuses_is_told_in_a_line(lesson: Lesson, tmp_path: Path) -> None:
    file = tmp_path / NAME
    file.write_bytes(CONTENT)
    lesson.robot.refuses = "the file is too large (at most 8000000 bytes)"
    lesson.phone.write("#load-file", str(file))
    lesson.reads("#said", f"{NAME}: the file is too large (at most 8000000 bytes)")


async def test_an_upload_needs_the_cookie_and_a_page_of_ours() -> None:
    async with served() as page:
        ours = {**page.cookie, "Origin": f"http://127.0.0.1:{page.port}"}
        assert (await page.get("/upload", {"Origin": ours["Origin"]}, method="POST", body=b"PK")).status == 403
        elsewhere = {**page.cookie, "Origin": "http://evil.example"}
        assert (await page.get("/upload", elsewhere, method="POST", body=b"PK")).status == 403
        assert not page.robot.told_of("upload")
        got = await page.get("/upload", ours, method="POST", body=b"PK")
        assert (got.status, len(json.loads(got.body)["upload"])) == (200, 16)
        assert (await page.get("/upload", ours, method="POST", body=b"")).status == 400
        large = await page.get("/upload", ours, method="POST", body=bytes(MOST_UPLOAD_BYTES + 1))
        assert large.status == 413
        assert "8 MB" in large.body
        assert len(page.robot.told_of("upload")) == 1


async def test_a_download_needs_the_cookie_and_a_file_of_the_robot() -> None:
    async with served() as page:
        page.robot.files[NAME] = CONTENT
        assert (await page.get(f"/files/{NAME}")).status == 403
        got = await page.get(f"/files/{NAME}", page.cookie)
        assert (got.status, got.content) == (200, CONTENT)
        assert got.headers["Content-Disposition"] == f"attachment; filename*=UTF-8''{NAME}"
        missing = await page.get("/files/robot.key", page.cookie)
        assert missing.status == 404
        assert missing.body
        page.robot.silent = True
        assert (await page.get(f"/files/{NAME}", page.cookie)).status == 504
