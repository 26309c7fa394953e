"""The same robots at two stages."""

from collections.abc import Sequence

from kurt2rt.experiments.lockstep.report import label_of
from kurt2rt.experiments.phases.summary import Paired
from kurt2rt.experiments.study.table import Table


def paired_sheet(title: str, pairs: Sequence[Paired], note: str) -> Table:
    """The same robots at two stages."""
    rows = []
    for each in pairs:
        sure = "better" if each.surely_better else "worse" if each.surely_worse else ""
        change = each.difference
        rows.append(
            (
                label_of(each.world),
                each.measure.name,
                f"{each.before:.3f}",
                f"{each.after:.3f}",
                f"{change.value:+.3f}",
                f"{change.low:+.3f} to {change.high:+.3f}",
                f"{each.better}",
                f"{each.worse}",
                "" if each.measure.clean is None else f"{each.no_longer_clean}",
                sure,
            )
        )
    columns = ("world", "measure", "before", "after", "change", "95 %", "better", "worse", "no longer clean", "surely")
    return Table(title, columns, tuple(rows), words=2, note=note)
