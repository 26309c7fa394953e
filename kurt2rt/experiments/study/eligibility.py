"""Conditions for judging results by the targets."""

from collections.abc import Iterator, Sequence

ROBOTS = 20
"""Number of robots for which targets are defined."""
CHOSEN_ON = range(80)
"""Seeds that settings were searched on; results of such robots are not judged."""


def reasons_against_judging(seeds: Sequence[int]) -> Iterator[str]:
    """Yield the reasons against judging; none for enough robots with new seeds."""
    robots = len(seeds)
    if robots < ROBOTS:
        yield f"{robots} robot{'' if robots == 1 else 's'} only; the numbers are asked of {ROBOTS}."
    if known := sum(seed in CHOSEN_ON for seed in seeds):
        yield (
            f"{known} of the seeds are among {CHOSEN_ON[0]} to {CHOSEN_ON[-1]}, on which settings were chosen; "
            "give others."
        )
