"""What was asked, and what came."""

import math
from collections.abc import Iterator

from kurt2rt.experiments.route.study import Summary
from kurt2rt.experiments.route.variants import TAUGHT
from kurt2rt.experiments.shown.verdict import Verdict
from kurt2rt.tasks.settings import PaperResult

WITHOUT_ERROR = {8: 18 / 20, 12: 18 / 20, 16: 15 / 20}
"""Share of the robots that are to drive to the end without an error, by decisions of the route."""
RIGHT = 0.99
"""Share of all decisions that is to be right."""


def verdicts(summary: Summary, paper: PaperResult) -> Iterator[Verdict]:
    """All that is asked of routes of one length; of controls, and of other lengths, nothing is."""
    experiment = summary.experiment
    share = WITHOUT_ERROR.get(experiment.decisions)
    if experiment.variant != TAUGHT or share is None:
        return
    most = max(each.mid_rlas for each in summary.outcomes)
    yield Verdict("mid-level RLAs, most", f"at most {paper.rlas}", str(most), most <= paper.rlas)
    longest_s = max(each.teaching_s for each in summary.outcomes)
    yield Verdict("teaching", f"at most {paper.teaching_s:g} s", f"{longest_s:g} s", longest_s <= paper.teaching_s)
    right = summary.right.value
    yield Verdict("decisions right", f"at least {RIGHT:.0%}", f"{right:.2%} of {summary.junctions}", right >= RIGHT)
    needed = math.ceil(share * summary.robots - 1e-9)
    yield Verdict(
        "drives without an error",
        f"at least {needed} of {summary.robots}",
        f"{summary.without_error} of {summary.robots}",
        summary.without_error >= needed,
    )
