"""What was asked of the phases, beside what came."""

from collections.abc import Sequence

from kurt2rt.experiments.phases.study import PhasesStudy
from kurt2rt.experiments.phases.verdict import verdicts
from kurt2rt.experiments.study.table import Table
from kurt2rt.experiments.study.verdict_text import cells_of, result_text


def asked_sheet(study: PhasesStudy, reasons: Sequence[str]) -> Table:
    """Each number that was asked for beside what came, and whether it is met, unless there are reasons not to judge."""
    found = list(verdicts(study))
    met = sum(each.met for each in found)
    note = f"{met} of {len(found)} numbers asked for are met." if found else "Of this task nothing is asked."
    return Table(
        "What was asked",
        ("what", "asked", "came", "verdict"),
        tuple((*cells_of(each), result_text(each, reasons)) for each in found),
        words=4,
        note=" ".join(["Not judged.", *reasons]) if reasons else note,
    )
