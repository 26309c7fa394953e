"""Report of a benchmark run for the terminal and as JSON."""

import json
import os
import platform
from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np
from rich.console import Console
from rich.text import Text

from kurt2rt.checks.bench.result import BenchResult
from kurt2rt.platform.text_table import TextTable, print_whole


@dataclass(frozen=True, slots=True)
class BenchMachine:
    """Machine of the measurement and its load."""

    cores: int
    load_before: tuple[float, float, float]
    """Load average over 1, 5 and 15 minutes before the run, which itself adds about 1."""
    python: str
    numpy: str


def measure_machine() -> BenchMachine:
    """Return the usable cores, load averages and versions of this machine now; call it before the benchmarks."""
    return BenchMachine(len(os.sched_getaffinity(0)), os.getloadavg(), platform.python_version(), np.__version__)


def as_json(results: Sequence[BenchResult], machine: BenchMachine) -> str:
    """Return a JSON object with the machine, and each result with its ratio and verdicts."""
    rows = []
    for result in results:
        row = asdict(result)
        if result.reference is not None:
            row["reference"]["ratio"] = result.reference.ratio
        for goal, written in zip(result.goals, row["goals"], strict=True):
            written["met"] = goal.met
        rows.append(row)
    return json.dumps({"machine": asdict(machine), "results": rows}, indent=2)


def print_report(results: Sequence[BenchResult], machine: BenchMachine, console: Console) -> None:
    """Print the table, its notes and the machine's load."""
    table = TextTable()
    for heading in ("what", "median us", "p99 us", "reference", "us", "ratio", "goal: met"):
        number = heading in ("median us", "p99 us", "us", "ratio")
        table.add_column(heading, number=number, whole=heading == "goal: met")
    for result in results:
        reference = result.reference
        table.add_row(
            result.what,
            _format_us(result.took.median_us),
            _format_us(result.took.p99_us),
            reference.what if reference else "",
            _format_us(reference.took_us) if reference else "",
            f"{reference.ratio:.2f}" if reference else "",
            Text("\n").join(
                Text(f"{goal}: ") + (Text("yes", "green") if goal.met else Text("no", "bold red"))
                for goal in result.goals
            ),
        )
    print_whole(console, table, "")
    for result in results:
        if result.note:
            print_whole(console, f"{result.what.strip()}: worst {_format_us(result.took.worst_us)} us; {result.note}")
    busy = ", ".join(f"{load:.2f}" for load in machine.load_before)
    print_whole(
        console,
        f"The goals are meant for an idle machine. This one has {machine.cores} usable cores and had "
        f"a load average of {busy} before the run; Python {machine.python}, numpy {machine.numpy}.",
    )


def _format_us(time_us: float) -> str:
    return f"{time_us:.0f}" if time_us >= 1000 else f"{time_us:.1f}"
