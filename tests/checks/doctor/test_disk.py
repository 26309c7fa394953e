"""The folder where knowledge is kept, on this machine's real disk."""

import math
import os
import stat
from pathlib import Path

import pytest

from kurt2rt.checks.doctor.check_result import CheckResult, CheckStatus, FindingCode
from kurt2rt.checks.doctor.checks import check_disk, check_free_space, check_sync

SPACE = {FindingCode.SPACE, FindingCode.SPACE_LOW}
SYNC = {FindingCode.SYNC, FindingCode.SYNC_SLOW}


def only(findings: tuple[CheckResult, ...]) -> CheckResult:
    (finding,) = findings
    return finding


def test_check_disk_existing_folder_is_checked_and_unchanged(tmp_path: Path) -> None:
    (tmp_path / "knowledge.sqlite").write_bytes(b"not ours to touch")
    findings = check_disk(tmp_path)
    folder, space, sync, log = (finding.code for finding in findings)
    assert (folder, log) == (FindingCode.FOLDER, FindingCode.SQLITE_LOG)
    assert space in SPACE
    assert sync in SYNC
    assert not any(finding.forbids_run for finding in findings)
    assert findings[0].status is CheckStatus.OK
    assert [each.name for each in tmp_path.iterdir()] == ["knowledge.sqlite"]
    assert (tmp_path / "knowledge.sqlite").read_bytes() == b"not ours to touch"


def test_check_disk_missing_folder_is_judged_by_its_parent(tmp_path: Path) -> None:
    folder = tmp_path / "robots" / "anna's"
    findings = check_disk(folder)
    assert len(findings) == 4
    assert findings[0].status is CheckStatus.OK
    assert findings[0].code is FindingCode.FOLDER_TO_MAKE
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["", "kurt2rt"], ids=["itself", "its parent"])
def test_a_folder_that_cannot_be_written_forbids_to_run(name: str) -> None:
    finding = only(check_disk(Path("/proc", name)))  # /proc refuses root too
    assert finding.forbids_run
    assert finding.code is FindingCode.FOLDER_UNWRITABLE


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write a read-only folder")
def test_a_read_only_folder_forbids_to_run(tmp_path: Path) -> None:
    tmp_path.chmod(stat.S_IRUSR | stat.S_IXUSR)
    assert only(check_disk(tmp_path)).forbids_run


def test_room_is_asked_for_in_two_steps(tmp_path: Path) -> None:
    enormous = 2**80
    assert check_free_space(tmp_path, 0, 0).status is CheckStatus.OK
    assert check_free_space(tmp_path, 0, enormous).status is CheckStatus.WARNING
    assert check_free_space(tmp_path, enormous, enormous).forbids_run


def test_a_disk_that_is_slow_to_sync_is_a_warning(tmp_path: Path) -> None:
    assert check_sync(tmp_path, math.inf).status is CheckStatus.OK
    finding = check_sync(tmp_path, limit_s=0.0)
    assert finding.status is CheckStatus.WARNING
    assert finding.code is FindingCode.SYNC_SLOW
    assert not finding.forbids_run
