"""Reasons against judging the paper study."""

from collections.abc import Iterator

from kurt2rt.experiments.paper.plan import PaperPlan
from kurt2rt.experiments.study.eligibility import ROBOTS, reasons_against_judging

CHOSEN_ON_ROOMS = range(60)
"""Seeds of generated rooms that settings were searched on."""


def reasons_not_to_judge(plan: PaperPlan) -> Iterator[str]:
    """Yield the reasons against judging; none for a whole study with enough new robots and worlds."""
    if not plan.extent.is_whole:
        yield "A part only: it says that everything works, and nothing about the paper."
    yield from reasons_against_judging(plan.seeds)
    for each in plan.experiments_of("shipped"):
        unseen = each.settings.unseen
        if unseen is None:
            continue
        if unseen.kind == "rooms" and unseen.first in CHOSEN_ON_ROOMS:
            yield (
                f"{each.task.name}: some generated worlds are among rooms-{CHOSEN_ON_ROOMS[0]} to "
                f"rooms-{CHOSEN_ON_ROOMS[-1]}, on which settings were chosen; choose others."
            )
        driven = {world for job in each.jobs for world in job.unseen}
        if len(plan.seeds) >= ROBOTS and len(driven) < unseen.count:
            yield (
                f"{each.task.name}: {unseen.count - len(driven)} of the {unseen.count} generated worlds are left out "
                f"by these seeds; give {ROBOTS} that follow each other."
            )
