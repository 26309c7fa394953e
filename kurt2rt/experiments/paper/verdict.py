"""What was asked, and what came."""

import math
from collections.abc import Iterator

from kurt2rt.experiments.paper.settings import AskedSettings
from kurt2rt.experiments.paper.summary import Summary, WorldSummary, success_text
from kurt2rt.experiments.shown.verdict import Verdict


def verdicts(summary: Summary) -> Iterator[Verdict]:
    """All that is asked of one experiment."""
    asked = summary.settings.asked
    if asked.rlas_at_most:
        median = summary.rlas.median
        yield Verdict("RLAs, median", f"at most {asked.rlas_at_most}", f"{median:g}", median <= asked.rlas_at_most)
    paper_s = summary.task.paper.teaching_s
    if asked != AskedSettings() and paper_s:
        met = summary.teaching_s <= paper_s
        yield Verdict("teaching", f"at most {paper_s:g} s", f"{summary.teaching_s:g} s", met)
    unseen = summary.settings.unseen
    for world in summary.worlds:
        if world.world:
            share = asked.success_at_least.get(world.world)
        else:
            share = unseen.success_at_least if unseen is not None else None
        if share is not None:
            yield _success(world, share)
        if asked.right_at_least:
            came = "no junction" if world.right is None else f"{world.right.value:.1%} of {world.junctions}"
            met = world.right is not None and world.right.value >= asked.right_at_least
            yield Verdict(f"junctions right in {world.label}", f"at least {asked.right_at_least:.0%}", came, met)
        if asked.collisions_below_per_10_min:
            limit, rate = asked.collisions_below_per_10_min, world.collisions.value
            yield Verdict(f"collisions in 10 min in {world.label}", f"below {limit:g}", f"{rate:.2f}", rate < limit)


def _success(world: WorldSummary, share: float) -> Verdict:
    # 0.9 of 20 is 18, also where the product is a trifle more.
    needed = math.ceil(share * world.judged - 1e-9)
    return Verdict(
        f"success in {world.label}",
        f"at least {needed} of {world.judged}",
        success_text(world),
        met=world.judged > 0 and world.succeeded >= needed,
        judged=world.judged > 0,
    )
