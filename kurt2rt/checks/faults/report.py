"""Report of the fault cases for the terminal and as JSON."""

import json
from collections.abc import Sequence
from dataclasses import asdict

from rich.console import Console
from rich.text import Text

from kurt2rt.checks.faults.complaint import text_of
from kurt2rt.checks.faults.outcome import Standstill
from kurt2rt.checks.faults.stop_times import StopTime
from kurt2rt.checks.faults.suite import FaultTrial
from kurt2rt.checks.faults.table import KINDS, TARGETS, Kind, Target
from kurt2rt.platform.text_table import TextTable, print_whole


def print_report(trials: Sequence[FaultTrial], times: Sequence[StopTime], console: Console) -> None:
    """Print the outcome of each fault, the stop times and the deviations."""
    cells: dict[tuple[Target, Kind], list[FaultTrial]] = {}
    for trial in trials:
        cells.setdefault((trial.case.target, trial.case.kind), []).append(trial)
    kinds = [kind for kind in KINDS if any(kind == each for _, each in cells)]
    table = TextTable("", *kinds)
    for target in TARGETS:
        row = [_cell(cells.get((target, kind), ())) for kind in kinds]
        if any(row):
            table.add_row("\n".join(target.split("_", 1)).replace("_", " "), *row)
    print_whole(
        console,
        table,
        "\nstands: until the fault is over at least. asks: stands because it does not know the situation. stutters: "
        "stands for moments. drives: never stands.\n"
        "ms: from the fault's beginning to the standstill at the robot's end of the bus, the worst of all seeds. "
        "Below it, what it needs besides the end of the fault to drive on: a teacher's resume, a new press of his "
        "hand, a new start of the program.\n",
    )
    if times:
        print_whole(console, _times(times), "")
    _print_complaints(trials, console)


def as_json(trials: Sequence[FaultTrial], times: Sequence[StopTime]) -> str:
    """Return a JSON object with the stop times, and each trial with its row, outcome and deviations."""
    return json.dumps(
        {
            "stop_times": [{**asdict(each), "met": each.met} for each in times],
            "trials": [
                {
                    **asdict(outcome),
                    "first": _row(outcome.first),
                    "last": _row(outcome.last),
                    "must": case.must.model_dump(exclude_none=True),
                    "passed": verdict.passed,
                    "problems": [text_of(each) for each in outcome.problems],
                    "complaints": [text_of(each) for each in verdict.complaints],
                    "codes": [each.code for each in verdict.complaints],
                }
                for case, outcome, verdict in trials
            ],
        },
        indent=2,
    )


def _row(stand: Standstill | None) -> dict[str, object] | None:
    return None if stand is None else stand._asdict()


def _cell(trials: Sequence[FaultTrial]) -> Text:
    if not trials:
        return Text()
    must = trials[0].case.must
    lines: list[str] = ["drives" if must.leads_to == "drives_on" else must.leads_to]
    stands = [trial.outcome.first if must.leads_to == "stutters" else trial.outcome.last for trial in trials]
    after_s = [stand.after_s for stand in stands if stand is not None]
    if must.leads_to != "drives_on" and after_s:
        lines.append(f"{max(after_s) * 1000:.0f} ms")
    if must.ends_by != "itself":
        lines.append(must.ends_by)
    if not all(trial.verdict.passed for trial in trials):
        return Text("\n".join((*lines, "NOT SO")), "bold red")
    if must.known_gap is not None:
        return Text("\n".join((*lines, "gap")), "yellow")
    return Text("\n".join(lines))


def _times(times: Sequence[StopTime]) -> TextTable:
    table = TextTable("stop time")
    for heading in ("goal ms", "median ms", "worst ms", "of"):
        table.add_column(heading, number=True)
    table.add_column("met")
    for each in times:
        table.add_row(
            each.what,
            f"{each.goal_s * 1000:.0f}",
            f"{each.median_s * 1000:.1f}",
            f"{each.worst_s * 1000:.1f}",
            str(each.trials),
            Text("yes", "green") if each.met else Text("no", "bold red"),
        )
    return table


def _print_complaints(trials: Sequence[FaultTrial], console: Console) -> None:
    failed = [trial for trial in trials if not trial.verdict.passed]
    gaps = {trial.case: trial for trial in trials if trial.case.must.known_gap is not None and trial.verdict.passed}
    for case in gaps:
        print_whole(console, Text(f"{case}: known gap: {case.must.known_gap}", "yellow"))
    for case, outcome, verdict in failed:
        for complaint in verdict.complaints:
            print_whole(console, Text(f"{case}, seed {outcome.seed}: {text_of(complaint)}", "red"))
    tried = len({trial.case for trial in trials})
    told = f"{tried} cases, {len(trials)} trials, {len(failed)} not as they must be, {len(gaps)} known gaps"
    print_whole(console, told)
