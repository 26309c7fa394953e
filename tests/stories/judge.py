"""Comparison of a drill's outcome with its row in the fault table."""

from collections.abc import Iterator

from tests.stories.drill import LOST_FRAMES, Outcome
from tests.stories.table import DrillRow

_MOMENT_S = 0.03
"""Longest standstill of a robot that reverses, some ticks."""


def judge(must: DrillRow, outcome: Outcome) -> list[str]:
    """Return what is not as the row says, or beyond the envelope."""
    return [
        *outcome.problems,
        *_limits(must, outcome),
        *_standstill(must, outcome),
        *_latch(must, outcome),
        *_end(must, outcome),
    ]


def _limits(must: DrillRow, outcome: Outcome) -> Iterator[str]:
    if not outcome.acted:
        yield "nothing failed"
    if outcome.old_frames > must.old_frames:
        yield f"{outcome.old_frames} old set points arrived at the robot, allowed are {must.old_frames}"
    if must.counts is not None and not outcome.counted.get(must.counts):
        yield f"no {must.counts} were counted"
    if must.counts != LOST_FRAMES and outcome.counted.get(LOST_FRAMES):
        yield f"the log must lose nothing, lost {outcome.counted[LOST_FRAMES]} frames"


def _standstill(must: DrillRow, outcome: Outcome) -> Iterator[str]:
    if must.leads_to == "drives_on":
        if outcome.first is not None and outcome.longest_stand_s > _MOMENT_S:
            yield f"must drive on, stood for {outcome.longest_stand_s:.2f} s because of {outcome.first.because}"
        return
    stand = outcome.first if must.leads_to == "stutters" else outcome.last
    if stand is None or must.within_s is None:
        yield f"must stand because of {must.words}, did not"
        return
    if stand.after_s > must.within_s:
        yield f"must stand within {must.within_s * 1000:.0f} ms, took {stand.after_s * 1000:.1f}"
    if not set(must.words) & set(stand.because):
        yield f"must stand because of {must.words}, stood because of {stand.because}"
    if must.leads_to == "stutters" and not outcome.went_on:
        yield "must go on in between, stood to the end of the fault"


def _latch(must: DrillRow, outcome: Outcome) -> Iterator[str]:
    if outcome.latched != must.latches:
        yield f"must stay stopped because of {must.latches}, it was {outcome.latched} {outcome.ended_by}"
    elif (
        must.latches_within_s is not None
        and outcome.latched_after_s is not None
        and outcome.latched_after_s > must.latches_within_s
    ):
        yield f"must be stopped for good within {must.latches_within_s:g} s, took {outcome.latched_after_s:.3f}"


def _end(must: DrillRow, outcome: Outcome) -> Iterator[str]:
    if must.ends_by == "itself":
        if not outcome.drove_by_itself:
            yield "must drive by itself when the fault is over, did not"
        return
    if outcome.drove_by_itself:
        yield f"must wait for {must.ends_by} when the fault is over, drove by itself"
    if not outcome.drove_when_told:
        yield f"must drive after {must.ends_by}, did not"
