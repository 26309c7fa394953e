"""Verdicts on robots that were taught on in a new world."""

import math
from collections.abc import Iterator

from kurt2rt.experiments.study.verdict import Target, Verdict
from kurt2rt.experiments.transfer.plan import TransferStudy, TransferSummary

RIGHT_SHARE = 18 / 20
"""Share of the robots that are to be right in the new world."""
MOST_PRESSES = 10
"""Presses until right that half of the robots may need at most."""


def verdicts(summary: TransferSummary, study: TransferStudy) -> Iterator[Verdict]:
    """Yield the verdicts on robots with the knowledge of home; none for controls, or if no exam has a verdict."""
    judged = summary.judged
    if not summary.studied or not judged:
        return
    presses = study.plan.after[-1]
    right, needed = summary.right_by(presses), math.ceil(RIGHT_SHARE * len(judged) - 1e-9)
    there = {"presses": presses, "needed": needed, "judged": len(judged), "right": right}
    yield Verdict(Target.RIGHT_IN_NEW_WORLD, there, right >= needed)
    median = median_of([each.presses_until_right for each in judged])
    shown = f"{median:g}" if math.isfinite(median) else f"more than {presses}"
    yield Verdict(Target.PRESSES_UNTIL_RIGHT, {"limit": MOST_PRESSES, "median": shown}, median <= MOST_PRESSES)
    robots = len(summary.outcomes)
    after = sum(each.home_when_right.passed for each in summary.outcomes)
    before = sum(each.drive.passed for each in study.home)
    yield Verdict(Target.RIGHT_AT_HOME, {"robots": robots, "right": after, "before": before}, after == robots)


def median_of(values: list[float]) -> float:
    """Return the median of counts or times in s, which may be infinite; of two middle values their mean."""
    ordered = sorted(values)
    low, high = ordered[(len(ordered) - 1) // 2], ordered[len(ordered) // 2]
    return low if low == high else (low + high) / 2
