"""Targets of a study: what was asked, what came, and whether these robots may be judged by it."""

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from kurt2rt.experiments.study.table import Table

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


class Verdict(NamedTuple):
    """Target of a study: its name, the number asked for, the number that came, and whether it was met.

    Tables show it as met, MISSED or not judged; targets were written down before the runs.
    """

    what: str
    asked: str
    came: str
    met: bool
    judged: bool = True
    """False: there is nothing to judge by."""

    @property
    def result(self) -> str:
        """Result in a word; a miss is in capitals, so that it is seen without color."""
        return ("met" if self.met else "MISSED") if self.judged else "not judged"


def needed_of(share: float, robots: int) -> int:
    """Return the number of robots that a share, 0 to 1, asks for: 0.9 of 20 is 18, also where the product is more."""
    return math.ceil(share * robots - 1e-9)


def targets_table(
    verdicts: Iterable[tuple[tuple[str, ...], Verdict]],
    not_judged_because: Sequence[str],
    *,
    title: str = "What was asked",
    headings: tuple[str, ...] = (),
    note_without_targets: str = "",
) -> Table:
    """Return a row for each verdict; with reasons against judging, all results are `not judged`.

    `verdicts`: each with the cells of the columns `headings`, which come first.
    """
    found = list(verdicts)
    met = sum(verdict.met for _, verdict in found)
    note = f"{met} of {len(found)} numbers asked for are met." if found else note_without_targets
    shown = [(cells, each._replace(judged=each.judged and not not_judged_because)) for cells, each in found]
    return Table(
        title,
        (*headings, "what", "asked", "came", "verdict"),
        tuple((*cells, each.what, each.asked, each.came, each.result) for cells, each in shown),
        words=len(headings) + 4,
        note=" ".join(["Not judged.", *not_judged_because]) if not_judged_because else note,
    )
