"""Verdicts on one experiment of the paper."""

import math
from collections.abc import Iterator

from kurt2rt.experiments.paper.settings import AskedSettings
from kurt2rt.experiments.paper.summary import PaperSummary, WorldSummary, success_text
from kurt2rt.experiments.study.verdict import Target, Values, Verdict


def verdicts(summary: PaperSummary) -> Iterator[Verdict]:
    """Yield the verdict on each target of the experiment."""
    asked = summary.settings.asked
    if asked.rlas_at_most:
        median = summary.rlas.median
        yield Verdict(Target.RLAS, {"limit": asked.rlas_at_most, "rlas": median}, median <= asked.rlas_at_most)
    paper_s = summary.task.paper.teaching_s
    if asked != AskedSettings() and paper_s:
        met = summary.teaching_s <= paper_s
        yield Verdict(Target.TEACHING, {"limit_s": paper_s, "teaching_s": summary.teaching_s}, met)
    unseen = summary.settings.unseen
    for world in summary.worlds:
        if world.world:
            share = asked.success_at_least.get(world.world)
        else:
            share = unseen.success_at_least if unseen is not None else None
        if share is not None:
            yield _success(world, share)
        if asked.right_at_least:
            right = "no junction" if world.right is None else f"{world.right.value:.1%} of {world.junctions}"
            met = world.right is not None and world.right.value >= asked.right_at_least
            values: Values = {"world": world.label, "share": asked.right_at_least, "right": right}
            yield Verdict(Target.JUNCTIONS_RIGHT, values, met)
        if asked.collisions_below_per_10_min:
            limit, rate = asked.collisions_below_per_10_min, world.collisions.value
            yield Verdict(Target.COLLISIONS, {"world": world.label, "limit": limit, "rate": rate}, rate < limit)


def _success(world: WorldSummary, share: float) -> Verdict:
    # 0.9 of 20 is 18, also where the product is a trifle more.
    needed = math.ceil(share * world.judged - 1e-9)
    return Verdict(
        Target.SUCCESS,
        {"world": world.label, "needed": needed, "judged": world.judged, "success": success_text(world)},
        met=world.judged > 0 and world.succeeded >= needed,
        judged=world.judged > 0,
    )
