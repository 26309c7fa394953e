"""The report of a benchmark run, for people and for programs."""

import json
import os
import platform
from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np
from rich.console import Console
from rich.table import Table
from rich.text import Text

from kurt2rt.bench.result import Result


@dataclass(frozen=True, slots=True)
class Machine:
    """Where it was measured, and how busy that was with other things."""

    cores: int
    load_before: tuple[float, float, float]
    """Load average over 1, 5 and 15 minutes; of the run itself comes about 1."""
    python: str
    numpy: str


def look_at_machine() -> Machine:
    """The machine as it is now."""
    return Machine(len(os.sched_getaffinity(0)), os.getloadavg(), platform.python_version(), np.__version__)


def as_json(results: Sequence[Result], machine: Machine) -> str:
    """A JSON object: the machine, and one object per result with its ratio and with each goal's verdict."""
    rows = []
    for result in results:
        row = asdict(result)
        if result.reference is not None:
            row["reference"]["ratio"] = result.reference.ratio
        for goal, written in zip(result.goals, row["goals"], strict=True):
            written["met"] = goal.met
        rows.append(row)
    return json.dumps({"machine": asdict(machine), "results": rows}, indent=2)


def print_report(results: Sequence[Result], machine: Machine, console: Console) -> None:
    """One table, what one has to know to read it, and how busy the machine was."""
    table = Table()
    for heading in ("what", "median us", "p99 us", "reference", "its us", "ratio", "goal", "met"):
        table.add_column(heading, justify="right" if heading.endswith("us") or heading == "ratio" else "left")
    for result in results:
        reference = result.reference
        table.add_row(
            result.what,
            f"{result.took.median_us:.1f}",
            f"{result.took.p99_us:.1f}",
            reference.what if reference else "",
            f"{reference.took_us:.1f}" if reference else "",
            f"{reference.ratio:.2f}" if reference else "",
            "\n".join(map(str, result.goals)),
            Text("\n").join(Text("yes", "green") if goal.met else Text("no", "bold red") for goal in result.goals),
        )
    console.print(table)
    for result in results:
        if result.note:
            console.print(Text(f"{result.what.strip()}: worst {result.took.worst_us:.1f} us; {result.note}"))
    busy = ", ".join(f"{load:.2f}" for load in machine.load_before)
    console.print(
        Text(
            f"The goals are meant for an idle machine. This one has {machine.cores} usable cores and had "
            f"a load average of {busy} before the run; Python {machine.python}, numpy {machine.numpy}."
        )
    )
