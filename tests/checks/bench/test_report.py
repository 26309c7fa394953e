"""The report, of results with known numbers."""

import io
import json

from rich.console import Console

from kurt2rt.checks.bench.report import BenchMachine, as_json, measure_machine, print_report
from kurt2rt.checks.bench.result import BenchGoal, BenchResult, Reference
from kurt2rt.platform.ledger import Percentiles, percentiles_of

MACHINE = BenchMachine(2, (0.5, 0.25, 0.125), "3.11.7", "2.1.0")
RESULTS = (
    BenchResult("tick", "  sense", Percentiles(12.25, 30.0, 31.0)),
    BenchResult(
        "lateness",
        "tick begins late",
        Percentiles(70.0, 200.0, 900.0),
        Reference("asyncio.sleep, p99", 1300.0, 200.0),
        (BenchGoal("ratio", 6.5, 5.0, at_least=True), BenchGoal("missed", 3, 0)),
        "6000 ticks",
    ),
)


def test_print_report_shows_numbers_goals_and_machine_load() -> None:
    out = io.StringIO()
    print_report(RESULTS, MACHINE, Console(file=out, width=120))
    lines = out.getvalue().splitlines()
    (late,) = (line for line in lines if line.strip().startswith(f"{RESULTS[1].what}  "))
    assert late.split()[3:] == ["70.0", "200.0", "asyncio.sleep,", "p99", "1300", "6.50", "ratio", ">=", "5:", "yes"]
    assert lines[lines.index(late) + 1].split() == ["missed", "<=", "0:", "no"]
    (note,) = (line for line in lines if line.startswith(f"{RESULTS[1].what}: "))
    assert "900.0 us" in note
    assert note.endswith(RESULTS[1].note)
    assert "0.50, 0.25, 0.12" in " ".join(lines)


def test_print_report_narrow_terminal_keeps_verdict_and_goal() -> None:
    out = io.StringIO()
    print_report(RESULTS, MACHINE, Console(file=out, width=80))
    lines = [line.split() for line in out.getvalue().splitlines()]
    assert any(line[-4:] == ["ratio", ">=", "5:", "yes"] for line in lines)
    assert any(line[-4:] == ["missed", "<=", "0:", "no"] for line in lines)


def test_a_program_gets_ratio_and_verdicts() -> None:
    report = json.loads(as_json(RESULTS, MACHINE))
    assert report["machine"]["load_before"] == [0.5, 0.25, 0.125]
    stage, late = report["results"]
    assert stage["reference"] is None
    assert stage["took"] == {"median_us": 12.25, "p99_us": 30.0, "worst_us": 31.0}
    assert late["reference"]["ratio"] == 6.5
    assert [goal["met"] for goal in late["goals"]] == [True, False]


def test_this_machine_has_a_core() -> None:
    assert measure_machine().cores >= 1


def test_times_in_nanoseconds_become_microseconds() -> None:
    assert percentiles_of([1000, 2000, 9000]) == Percentiles(2.0, 8.86, 9.0)
