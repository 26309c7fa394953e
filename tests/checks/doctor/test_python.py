"""Python and packages: what this machine has, and what another might."""

from pathlib import Path

import pytest

from kurt2rt.checks.doctor.check_result import CheckStatus, FindingCode
from kurt2rt.checks.doctor.checks import check_package, check_python


def test_an_old_python_forbids_to_run() -> None:
    finding = check_python((3, 10, 14))
    assert finding.forbids_run
    assert (finding.code, finding.values) == (FindingCode.PYTHON_OLD, {"version": "3.10.14", "least": "3.11"})


def test_check_package_missing_is_named_and_allows_a_run() -> None:
    finding = check_package("kurt2rt_no_such_package", "nothing")
    assert finding.status is CheckStatus.MISSING
    assert finding.code is FindingCode.PACKAGE_MISSING
    assert "No module named 'kurt2rt_no_such_package'" in str(finding.values["fault"])
    assert not finding.forbids_run


def test_check_package_crash_on_import_spares_the_doctor(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "crashes_on_import.py").write_text("import os, signal\nos.kill(os.getpid(), signal.SIGKILL)\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    finding = check_package("crashes_on_import", "nothing")
    assert finding.status is CheckStatus.MISSING
    assert "-9" in str(finding.values["fault"])


def test_a_python_that_cannot_be_started_twice_is_said_so(tmp_path: Path) -> None:
    finding = check_package("rich", "tables", python=str(tmp_path / "python"))
    assert finding.status is CheckStatus.MISSING
    assert str(tmp_path / "python") in str(finding.values["fault"])
