"""Report of a commissioning: steps, to-do list and verdict."""

from collections.abc import Sequence

from rich.console import Console
from rich.text import Text

from kurt2rt.checks.commission.progress import Progress, StepOutcome
from kurt2rt.checks.commission.step import CommissionStep
from kurt2rt.platform.text_table import TextTable, print_whole

_STYLES = {StepOutcome.PASSED: "green", StepOutcome.FAILED: "bold red", StepOutcome.SKIPPED: "yellow"}


def _verdict(progress: Progress, steps: Sequence[CommissionStep]) -> str:
    passed = all(progress.outcome_of(step.name) is StepOutcome.PASSED for step in steps)
    return "PASSED" if passed else "not passed"


def as_text(progress: Progress, steps: Sequence[CommissionStep]) -> str:
    """Return the full record of each step as text."""
    lines = [f"{progress.name} on {progress.bus}, begun with {progress.base}: {_verdict(progress, steps)}"]
    for step in steps:
        record = progress.steps.get(step.name)
        lines += ["", f"{step.title}  [{step.name}]"]
        if record is None:
            lines.append("  not taken")
            continue
        lines.append(f"  {record.outcome}, {record.at} UTC, {record.who}")
        lines += [f"    {each}" for each in record.measured]
        lines += [f"  TO DO: {each}" for each in record.to_do]
    return "\n".join(lines) + "\n"


def print_report(progress: Progress, steps: Sequence[CommissionStep], console: Console) -> None:
    """Print table, to-do list and verdict."""
    table = TextTable("step", "outcome", "when (UTC)", "who")
    to_do: list[str] = []
    for step in steps:
        record = progress.steps.get(step.name)
        if record is None:
            table.add_row(Text(step.name), Text("not taken"), "", "")
            continue
        outcome = Text(record.outcome, style=_STYLES[record.outcome])
        table.add_row(Text(step.name), outcome, Text(record.at), Text(record.who))
        to_do += [f"{step.name}: {each}" for each in record.to_do]
    print_whole(console, table, "")
    for each in to_do:
        console.print(Text(each), soft_wrap=not console.is_terminal)
    console.print(Text(f"{progress.name}: {_verdict(progress, steps)}", style="bold"), soft_wrap=True)
