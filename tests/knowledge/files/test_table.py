"""The RLAs as a table."""

import csv
import hashlib
from dataclasses import replace
from pathlib import Path

import pytest

from kurt2rt.core.rla.events import RlaCreated
from kurt2rt.knowledge.files.table import export_table
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.journal import Journal
from tests.knowledge.lessons import BINDING, STAMP, WITH_CRITIC, append, appraisal, created, entry, withdrawn


def exported(path: Path, folder: Path) -> list[list[str]]:
    saved = export_table(path, folder, STAMP)
    assert saved.name == "wall-following-20040426T100000-rlas.csv"
    content = (folder / saved.name).read_bytes()
    assert (saved.sha256, saved.size_bytes) == (hashlib.sha256(content).hexdigest(), len(content))
    with (folder / saved.name).open(newline="", encoding="utf-8") as file:
        return list(csv.reader(file))


def test_export_table_appraisal_rlas_have_own_columns(path: Path, tmp_path: Path) -> None:
    with Journal.open(path, WITH_CRITIC) as journal:
        journal.append([entry(1)])
        assert len(exported(path, tmp_path / "before")[0]) == len(exported(path, tmp_path / "again")[1])
        journal.append([JournalEntry(appraisal(2), STAMP), entry(3), JournalEntry(withdrawn(3), STAMP)])
        heading, *rows = exported(path, tmp_path / "out")

    assert heading[12:] == [*BINDING.feature_names, "critic: left_m", "critic: speed_m_s", "critic: bumped"]
    assert [(row[0], row[1], row[11]) for row in rows] == [
        ("1", "forward", "basic"),
        ("3", "ask", "basic"),
        ("2", "good", "critic"),
    ]
    assert rows[0][16:] == ["", "", ""]
    assert rows[2][12:] == ["", "", "", "", "0.4", "0.2", "0.0"]


@pytest.mark.parametrize("begin", ["=", "+", "-", "@", "\t", "\r", "\uff1d"])
def test_export_table_formula_text_is_quoted(path: Path, tmp_path: Path, begin: str) -> None:
    rla = replace(created(1).rla, action=f"{begin}HYPERLINK(A1)", behaviour=f"{begin}1+1")
    append(path, RlaCreated(rla))
    (heading, row) = exported(path, tmp_path)

    assert row[1] == f"'{begin}HYPERLINK(A1)"
    assert row[heading.index("behaviour")] == f"'{begin}1+1"
    assert row[-1] == "-5.0"


def test_export_table_number_text_is_not_quoted(path: Path, tmp_path: Path) -> None:
    rla = replace(created(1).rla, action="-1.5e3")
    append(path, RlaCreated(rla))
    assert exported(path, tmp_path)[1][1] == "-1.5e3"
