"""When results may be judged by the numbers that were asked for."""

from collections.abc import Iterator, Sequence

ROBOTS = 20
"""Robots that the numbers are asked of."""
CHOSEN_ON = range(80)
"""Seeds that settings were searched on; a robot made of one of them proves nothing."""


def reasons_against_judging(seeds: Sequence[int]) -> Iterator[str]:
    """Sentences; none where there are enough robots that nobody has seen."""
    robots = len(seeds)
    if robots < ROBOTS:
        yield f"{robots} robot{'' if robots == 1 else 's'} only; the numbers are asked of {ROBOTS}."
    if known := sum(seed in CHOSEN_ON for seed in seeds):
        yield (
            f"{known} of the seeds are among {CHOSEN_ON[0]} to {CHOSEN_ON[-1]}, on which settings were chosen; "
            "give others."
        )
