"""`kurt2rt bench`, as it is typed."""

import json
from pathlib import Path
from unittest.mock import AsyncMock

import pytest

from kurt2rt.checks.bench.suite import BenchName
from kurt2rt.experiments.lockstep.lesson_keeping import LessonLostError
from tests.checks.bench.test_report import RESULTS
from tests.cli.helpers import CommandLine


@pytest.mark.deep
def test_one_benchmark_prints_its_table_and_writes_json(kurt2rt: CommandLine, tmp_path: Path) -> None:
    file = tmp_path / "results.json"
    said = kurt2rt("bench", "--only", "match", "--quick", "--json", file, "--folder", tmp_path)
    assert said.exit_code == 0, said.err
    assert "100000 RLAs" in said.out
    report = json.loads(file.read_text(encoding="utf-8"))
    assert [row["what"].split()[-2] for row in report["results"]] == ["135", "1000", "100000"]
    assert all(row["reference"]["ratio"] > 0 for row in report["results"])
    assert list(tmp_path.iterdir()) == [file]


def test_bench_that_fails_prints_the_others_and_why(kurt2rt: CommandLine, monkeypatch: pytest.MonkeyPatch) -> None:
    lost = LessonLostError("the disk did not answer")
    monkeypatch.setattr("kurt2rt.checks.bench.suite.learn", AsyncMock())
    monkeypatch.setattr("kurt2rt.checks.bench.suite.measure_match", lambda *_: RESULTS[:1])
    monkeypatch.setattr("kurt2rt.checks.bench.suite.measure_lessons", AsyncMock(side_effect=lost))
    said = kurt2rt("bench", "--only", "match,lesson")
    assert RESULTS[0].what in said.out
    assert "kurt2rt: bench lesson: the disk did not answer" in said.err
    assert said.exit_code == lost.exit_code


def test_bench_unknown_name_is_refused_with_the_known_ones(kurt2rt: CommandLine) -> None:
    line = kurt2rt.misused("bench", "--only", "match,speed")
    assert "speed" in line
    assert ", ".join(BenchName) in line


def test_bench_unwritable_report_is_refused_before_the_work(kurt2rt: CommandLine, tmp_path: Path) -> None:
    file = tmp_path / "not there" / "results.json"
    assert str(file.parent) in kurt2rt.misused("bench", "--json", file)


def test_help_says_what_is_measured_and_what_the_exit_code_means(kurt2rt: CommandLine) -> None:
    out = " ".join(kurt2rt("bench", "--help").out.split())
    assert all(bench in out for bench in BenchName)
    assert "code 0" in out
