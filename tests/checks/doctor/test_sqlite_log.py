"""SQLite and its write-ahead log."""

import sqlite3
from contextlib import closing
from pathlib import Path

from kurt2rt.checks.doctor.check_result import CheckStatus, FindingCode
from kurt2rt.checks.doctor.checks import check_sqlite, check_sqlite_log, log_fault


def test_an_sqlite_without_strict_tables_forbids_to_run() -> None:
    assert check_sqlite((3, 36, 0)).forbids_run
    assert check_sqlite((3, 37, 0)).status is CheckStatus.OK


def test_a_folder_where_sqlite_cannot_open_a_file_forbids_to_run(tmp_path: Path) -> None:
    finding = check_sqlite_log(tmp_path / "nowhere")
    assert finding.forbids_run
    assert finding.code is FindingCode.SQLITE_LOG_FAILS


def test_a_database_that_keeps_no_log_is_found_out() -> None:
    with closing(sqlite3.connect(":memory:")) as writer, closing(sqlite3.connect(":memory:")) as reader:
        assert "memory" in log_fault(writer, reader)


def test_a_reader_that_does_not_see_the_lesson_is_found_out(tmp_path: Path) -> None:
    def connect(name: str) -> sqlite3.Connection:
        return sqlite3.connect(tmp_path / name, isolation_level=None)

    with closing(connect("writer")) as writer, closing(connect("elsewhere")) as reader:
        reader.execute("CREATE TABLE lesson (number INTEGER)")
        assert "(0, 0, 0)" in log_fault(writer, reader)
