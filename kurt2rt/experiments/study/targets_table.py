"""Table of targets: requirement, measured value and verdict of each."""

from collections.abc import Sequence

from kurt2rt.experiments.study.table import Table
from kurt2rt.experiments.study.verdict import Verdict
from kurt2rt.experiments.study.verdict_text import cells_of, result_text


def targets_table(
    verdicts: Sequence[tuple[tuple[str, ...], Verdict]],
    not_judged_because: Sequence[str],
    *,
    title: str = "What was asked",
    headings: tuple[str, ...] = (),
    note_without_targets: str = "",
) -> Table:
    """Return a row for each verdict; with reasons against judging, all results are `not judged`.

    Args:
        verdicts: each with the cells of the columns `headings`.
        note_without_targets: note if there are no verdicts.
    """
    met = sum(verdict.met for _, verdict in verdicts)
    note = f"{met} of {len(verdicts)} numbers asked for are met." if verdicts else note_without_targets
    return Table(
        title,
        (*headings, "what", "asked", "came", "verdict"),
        tuple((*cells, *cells_of(each), result_text(each, not_judged_because)) for cells, each in verdicts),
        words=len(headings) + 4,
        note=" ".join(["Not judged.", *not_judged_because]) if not_judged_because else note,
    )
