"""Comparison of a scenario's outcome with its row in the fault table."""

from typing import NamedTuple

from kurt2rt.checks.faults.complaint import Complaint, ComplaintCode, complaint
from kurt2rt.checks.faults.outcome import LOST_FRAMES, FaultOutcome
from kurt2rt.checks.faults.table import CaseSettings

_MOMENT_S = 0.03
"""Longest standstill of a robot that reverses, some ticks."""


class FaultVerdict(NamedTuple):
    """Result of one case."""

    passed: bool
    complaints: tuple[Complaint, ...]
    """Deviations from the row, including those that a known gap excuses."""


def judge(must: CaseSettings, outcome: FaultOutcome) -> FaultVerdict:
    """Return the verdict on an outcome by the required reaction `must`.

    A known gap passes while it exists, and excuses no violation of the envelope.
    """
    behaviour = (
        *_standstill_complaints(must, outcome),
        *_latch_complaints(must, outcome),
        *_end_complaints(must, outcome),
    )
    limits = _limit_complaints(must, outcome)
    if must.known_gap is None:
        return FaultVerdict(not (limits or behaviour), (*limits, *behaviour))
    if not behaviour:
        return FaultVerdict(passed=False, complaints=(*limits, complaint(ComplaintCode.GAP_CLOSED)))
    return FaultVerdict(not limits, (*limits, *behaviour))


def _limit_complaints(must: CaseSettings, outcome: FaultOutcome) -> tuple[Complaint, ...]:
    wrong = list(outcome.problems)
    if outcome.old_frames > must.old_frames:
        wrong.append(complaint(ComplaintCode.OLD_FRAMES, frames=outcome.old_frames, allowed=must.old_frames))
    if must.counts is not None and not outcome.counted.get(must.counts):
        wrong.append(complaint(ComplaintCode.NOT_COUNTED, counter=must.counts))
    if must.counts != LOST_FRAMES and outcome.counted.get(LOST_FRAMES):
        wrong.append(complaint(ComplaintCode.LOG_LOST_FRAMES, frames=outcome.counted[LOST_FRAMES]))
    return tuple(wrong)


def _standstill_complaints(must: CaseSettings, outcome: FaultOutcome) -> list[Complaint]:
    if must.leads_to == "drives_on":
        if outcome.first is not None and outcome.longest_stand_s > _MOMENT_S:
            because = _listed(outcome.first.because)
            return [complaint(ComplaintCode.STOOD, stood_s=outcome.longest_stand_s, because=because)]
        return []
    stand = outcome.first if must.leads_to == "stutters" else outcome.last
    if stand is None or must.within_s is None:
        return [complaint(ComplaintCode.DID_NOT_STAND, must=_listed(must.words))]
    wrong = []
    if stand.after_s > must.within_s:
        late = complaint(ComplaintCode.STOOD_LATE, must_ms=must.within_s * 1000, after_ms=stand.after_s * 1000)
        wrong.append(late)
    if not set(must.words) & set(stand.because):
        must_be, was = _listed(must.words), _listed(stand.because)
        wrong.append(complaint(ComplaintCode.STOOD_FOR_ANOTHER_CAUSE, must=must_be, because=was))
    if must.leads_to == "stutters" and not outcome.went_on:
        wrong.append(complaint(ComplaintCode.DID_NOT_GO_ON))
    return wrong


def _latch_complaints(must: CaseSettings, outcome: FaultOutcome) -> list[Complaint]:
    if outcome.latched != must.latches:
        latched = f"{outcome.latched} ({outcome.ended_by})" if outcome.ended_by else str(outcome.latched)
        return [complaint(ComplaintCode.OTHER_LATCH, must=str(must.latches), latched=latched)]
    if must.latches_within_s is None or outcome.latched_after_s is None:
        return []
    if outcome.latched_after_s > must.latches_within_s:
        within_s, after_s = must.latches_within_s, outcome.latched_after_s
        return [complaint(ComplaintCode.LATCHED_LATE, must_s=within_s, after_s=after_s)]
    return []


def _end_complaints(must: CaseSettings, outcome: FaultOutcome) -> list[Complaint]:
    if must.ends_by == "itself":
        return [] if outcome.drove_by_itself else [complaint(ComplaintCode.DID_NOT_DRIVE_BY_ITSELF)]
    wrong = []
    if outcome.drove_by_itself:
        wrong.append(complaint(ComplaintCode.DROVE_BY_ITSELF, must=must.ends_by))
    if not outcome.drove_when_told:
        wrong.append(complaint(ComplaintCode.DID_NOT_DRIVE_WHEN_TOLD, must=must.ends_by))
    return wrong


def _listed(words: tuple[str, ...]) -> str:
    return " or ".join(words) or "nothing"
