"""When results may be judged by the numbers that were asked for."""

from collections.abc import Iterator

from kurt2rt.experiments.paper.programme import ROBOTS, Programme

CHOSEN_ON = range(80)
"""Seeds that settings were searched on; a robot made of one of them proves nothing."""
CHOSEN_ON_ROOMS = range(60)
"""The same of generated rooms."""


def reasons_not_to_judge(programme: Programme) -> Iterator[str]:
    """Sentences; none where everything was done, by enough robots that nobody has seen, in such worlds."""
    if not programme.extent.is_whole:
        yield "A part only: it says that everything works, and nothing about the paper."
    robots = len(programme.seeds)
    if robots < ROBOTS:
        yield f"{robots} robot{'' if robots == 1 else 's'} only; the numbers are asked of {ROBOTS}."
    if known := sum(seed in CHOSEN_ON for seed in programme.seeds):
        yield f"{known} of the seeds are among {_span(CHOSEN_ON)}, on which settings were chosen; give others."
    for each in programme.experiments_of("shipped"):
        unseen = each.settings.unseen
        if unseen is None:
            continue
        if unseen.kind == "rooms" and unseen.first in CHOSEN_ON_ROOMS:
            yield (
                f"{each.task.name}: some generated worlds are among rooms-{CHOSEN_ON_ROOMS[0]} to "
                f"rooms-{CHOSEN_ON_ROOMS[-1]}, on which settings were chosen; choose others."
            )
        driven = {world for job in each.jobs for world in job.unseen}
        if robots >= ROBOTS and len(driven) < unseen.count:
            yield (
                f"{each.task.name}: {unseen.count - len(driven)} of the {unseen.count} generated worlds are left out "
                f"by these seeds; give {ROBOTS} that follow each other."
            )


def _span(numbers: range) -> str:
    return f"{numbers[0]} to {numbers[-1]}"
