"""Holds what a drill came to against what the table says."""

from typing import NamedTuple

from kurt2rt.faults.outcome import LOST_FRAMES, Outcome
from kurt2rt.faults.table import CaseSettings

_MOMENT_S = 0.03
"""A robot that turns round stands for a tick or two on its way."""


class Verdict(NamedTuple):
    """Whether a case is as it must be."""

    passed: bool
    complaints: tuple[str, ...]
    """What is not as it must be, one line each; of a known gap what the gap is."""


def judge(must: CaseSettings, outcome: Outcome) -> Verdict:
    """A known gap passes as long as it is one, and excuses nothing beyond the envelope."""
    behaviour = (*_about_standing(must, outcome), *_about_the_latch(must, outcome), *_about_the_end(must, outcome))
    limits = _about_the_limits(must, outcome)
    if must.known_gap is None:
        return Verdict(not (limits or behaviour), (*limits, *behaviour))
    if not behaviour:
        return Verdict(passed=False, complaints=(*limits, "the known gap is closed: take it out of the table"))
    return Verdict(not limits, (*limits, *behaviour))


def _about_the_limits(must: CaseSettings, outcome: Outcome) -> tuple[str, ...]:
    wrong = list(outcome.problems)
    if outcome.old_frames > must.old_frames:
        wrong.append(f"{outcome.old_frames} old set points arrived at the robot, allowed are {must.old_frames}")
    if must.counts is not None and not outcome.counted.get(must.counts):
        wrong.append(f"no {must.counts} were counted")
    if must.counts != LOST_FRAMES and outcome.counted.get(LOST_FRAMES):
        wrong.append(f"the log must lose nothing, lost {outcome.counted[LOST_FRAMES]} frames")
    return tuple(wrong)


def _about_standing(must: CaseSettings, outcome: Outcome) -> list[str]:
    if must.leads_to == "drives_on":
        if outcome.first is not None and outcome.longest_stand_s > _MOMENT_S:
            because = _listed(outcome.first.because)
            return [f"must drive on, stood for {outcome.longest_stand_s:.2f} s because of {because}"]
        return []
    stand = outcome.first if must.leads_to == "stutters" else outcome.last
    if stand is None or must.within_s is None:
        return [f"must stand because of {_listed(must.words)}, did not"]
    wrong = []
    if stand.after_s > must.within_s:
        wrong.append(f"must stand within {must.within_s * 1000:.0f} ms, took {stand.after_s * 1000:.1f}")
    if not set(must.words) & set(stand.because):
        wrong.append(f"must stand because of {_listed(must.words)}, stood because of {_listed(stand.because)}")
    if must.leads_to == "stutters" and not outcome.went_on:
        wrong.append("must go on in between, stood to the end of the fault")
    return wrong


def _about_the_latch(must: CaseSettings, outcome: Outcome) -> list[str]:
    if outcome.latched != must.latches:
        said = f"{outcome.latched} ({outcome.ended_by})" if outcome.ended_by else outcome.latched
        return [f"must stay stopped because of {must.latches}, it was {said}"]
    if must.latches_within_s is None or outcome.latched_after_s is None:
        return []
    if outcome.latched_after_s > must.latches_within_s:
        return [f"must be stopped for good within {must.latches_within_s:g} s, took {outcome.latched_after_s:.3f}"]
    return []


def _about_the_end(must: CaseSettings, outcome: Outcome) -> list[str]:
    if must.ends_by == "itself":
        return [] if outcome.drove_by_itself else ["must drive by itself when the fault is over, did not"]
    wrong = []
    if outcome.drove_by_itself:
        wrong.append(f"must wait for {must.ends_by} when the fault is over, drove by itself")
    if not outcome.drove_when_told:
        wrong.append(f"must drive after {must.ends_by}, did not")
    return wrong


def _listed(words: tuple[str, ...]) -> str:
    return " or ".join(words) or "nothing"
