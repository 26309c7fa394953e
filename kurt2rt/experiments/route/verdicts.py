"""Verdicts on routes of one length."""

import math
from collections.abc import Iterator

from kurt2rt.core.task_settings import PaperResult
from kurt2rt.experiments.route.summary import RouteSummary
from kurt2rt.experiments.route.variants import TAUGHT
from kurt2rt.experiments.study.verdict import Target, Verdict

WITHOUT_ERROR = {8: 18 / 20, 12: 18 / 20, 16: 15 / 20}
"""Share of the robots that are to drive to the end without an error, by decisions of the route."""
RIGHT = 0.99
"""Share of all decisions that is to be right."""


def verdicts(summary: RouteSummary, paper: PaperResult) -> Iterator[Verdict]:
    """Yield the verdicts on routes of one length, by the paper's results; none for controls and other lengths."""
    experiment = summary.experiment
    share = WITHOUT_ERROR.get(experiment.decisions)
    if experiment.variant != TAUGHT or share is None:
        return
    most = max(each.mid_rlas for each in summary.outcomes)
    yield Verdict(Target.MID_RLAS, {"limit": paper.rlas, "most": most}, most <= paper.rlas)
    longest_s = max(each.teaching_s for each in summary.outcomes)
    teaching = {"limit_s": paper.teaching_s, "teaching_s": longest_s}
    yield Verdict(Target.TEACHING, teaching, longest_s <= paper.teaching_s)
    right = summary.right.value
    decisions = {"share": RIGHT, "right": right, "junctions": summary.junctions}
    yield Verdict(Target.DECISIONS_RIGHT, decisions, right >= RIGHT)
    needed = math.ceil(share * summary.robots - 1e-9)
    drives = {"needed": needed, "robots": summary.robots, "without_error": summary.without_error}
    yield Verdict(Target.WITHOUT_ERROR, drives, summary.without_error >= needed)
