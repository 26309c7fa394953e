"""Conditions for judging results by the targets."""

from collections.abc import Iterator, Sequence

ROBOTS = 20
"""Number of robots for which targets are defined."""
CHOSEN_ON = (range(80), range(3000, 4000))
"""Seeds that settings were searched on; results of such robots are not judged."""


def reasons_against_judging(seeds: Sequence[int]) -> Iterator[str]:
    """Yield the reasons against judging; none for enough robots with new seeds."""
    robots = len(seeds)
    if robots < ROBOTS:
        yield f"{robots} robot{'' if robots == 1 else 's'} only; the numbers are asked of {ROBOTS}."
    for chosen in CHOSEN_ON:
        if known := sum(seed in chosen for seed in seeds):
            yield (
                f"{known} of the seeds are among {chosen[0]} to {chosen[-1]}, on which settings were chosen; "
                "give others."
            )
