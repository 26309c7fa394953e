"""Report of a soak for the terminal and as JSON."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from statistics import median
from typing import Any

from rich.console import Console
from rich.text import Text

from kurt2rt.checks.faults.complaint import Complaint, text_of
from kurt2rt.checks.faults.table import TARGETS
from kurt2rt.checks.soak.check_text import found_text, property_text
from kurt2rt.checks.soak.checks import format_memory_growth
from kurt2rt.checks.soak.faults import FaultResult
from kurt2rt.checks.soak.result import SoakResult
from kurt2rt.platform.text_table import TextTable, print_whole

_TOLD = 10
"""Complaints that are shown; all stored ones are in the JSON."""


def print_report(result: SoakResult, console: Console) -> None:
    """Print the checks, the faults and the day's numbers."""
    hours = result.simulated_s / 3600.0
    pace = result.simulated_s / max(result.took_s, 1e-9)
    print_whole(
        console,
        f"{hours:.2f} h in simulated time (seed {result.seed}), in {result.took_s / 60:.1f} min: {pace:.0f} times "
        f"real time. {result.ticks} ticks and {result.missed_ticks} missed ones, {len(result.starts)} starts, "
        f"{len(result.faults)} faults.\n",
    )
    print_whole(console, _checks(result))
    if result.faults:
        print_whole(console, "", _faults(result.faults), "")
    if result.minutes:
        _print_day(result, console)
    for module, grown_kb in list(result.grown_kb.items())[:_TOLD]:
        print_whole(console, f"{grown_kb:+10.1f} kB  {module}")
    for complaint in _complaints(result)[:_TOLD]:
        print_whole(console, Text(complaint, "red"))


def as_json(result: SoakResult) -> str:
    """Return a JSON object of the whole result, named tuples as objects."""
    plain: dict[str, Any] = asdict(result)
    plain["minutes"] = [each._asdict() for each in result.minutes]
    plain["checks"] = [
        {"code": each.code, "what": property_text(each), "passed": each.passed, "found": found_text(each)}
        for each in result.checks
    ]
    plain["starts"] = [
        {**each._asdict(), "complaint": "" if each.complaint is None else text_of(each.complaint)}
        for each in result.starts
    ]
    faults = [(each._asdict(), each.complaints) for each in result.faults]
    for row, complaints in faults:
        del row["complaints"]
        row |= {"complaint": texts_of(complaints), "codes": [each.code for each in complaints]}
    plain["faults"] = [row for row, _ in faults]
    plain["complaints"] = [text_of(each) for each in result.complaints]
    return json.dumps({"passed": result.passed, **plain}, indent=1)


def texts_of(complaints: Sequence[Complaint]) -> str:
    """Return the texts of all complaints in one line."""
    return "; ".join(map(text_of, complaints))


def _checks(result: SoakResult) -> TextTable:
    table = TextTable("what must hold", "", "found")
    for check in result.checks:
        verdict = Text("yes") if check.passed else Text("NO", style="bold red")
        table.add_row(property_text(check), verdict, found_text(check))
    return table


def _faults(faults: Sequence[FaultResult]) -> TextTable:
    table = TextTable("what failed")
    for column in ("times", "while it drove", "stood then", "after, median", "worst", "stopped for good"):
        table.add_column(column, number=True)
    for target in TARGETS:
        seen = [each for each in faults if each.target == target]
        if not seen:
            continue
        drove = [each for each in seen if each.drove]
        after_ms = [each.stood_after_s * 1000 for each in drove if each.stood_after_s is not None]
        table.add_row(
            target.replace("_", " "),
            str(len(seen)),
            str(len(drove)),
            str(len(after_ms)),
            f"{median(after_ms):.0f} ms" if after_ms else "",
            f"{max(after_ms):.0f} ms" if after_ms else "",
            str(sum(each.latched is not None for each in seen)),
        )
    return table


def _print_day(result: SoakResult, console: Console) -> None:
    minutes, last = result.minutes, result.minutes[-1]
    shares = [sum(getattr(each, name) for each in minutes) / len(minutes) for name in ("drives", "asks", "stopped")]
    print_whole(
        console,
        "Of its time the robot drove {:.0%}, asked {:.1%} and was stopped {:.0%}. ".format(*shares)
        + f"{last.lessons} lessons, {last.rlas} RLAs at the end. Memory {minutes[0].resident_mb:.1f} MB first, "
        f"{last.resident_mb:.1f} MB at the end.",
    )
    told = format_memory_growth(minutes, result.starts)
    if told:
        print_whole(console, told)
    print_whole(console, ", ".join(f"{count} {what}" for what, count in result.counted.items()) + ".\n")


def _complaints(result: SoakResult) -> list[str]:
    faults = [each for each in result.faults if each.complaints]
    starts = [(each.at_s, each.complaint) for each in result.starts if each.complaint is not None]
    return [
        *map(text_of, result.complaints),
        *(f"at {each.at_s:.3f} s: {each.target} {each.kind}: {texts_of(each.complaints)}" for each in faults),
        *(f"at {at_s:.3f} s: {text_of(complaint)}" for at_s, complaint in starts),
    ]
