"""What must hold after a soak."""

from collections.abc import Sequence
from statistics import median

from kurt2rt.soak.faults import FaultSeen
from kurt2rt.soak.result import Check, Minute, Start
from kurt2rt.soak.settings import LimitSettings
from kurt2rt.soak.witness import Complaints

HOUR_S = 3600.0
_ABOUT_S = 600.0


def memory_base_mb(minutes: Sequence[Minute]) -> float | None:
    """Memory at the end of the first hour, the median of its last ten minutes; None for a shorter soak."""
    base = [each.resident_mb for each in minutes if HOUR_S - _ABOUT_S < each.at_s <= HOUR_S]
    return median(base) if base and minutes[-1].at_s > HOUR_S else None


def memory_check(minutes: Sequence[Minute], limits: LimitSettings) -> Check:
    """No growth after the first hour: the median of any ten minutes against the last ten of that hour."""
    what = f"memory grows by no more than {limits.memory_mb:g} MB after the first hour"
    base_mb = memory_base_mb(minutes)
    later = [each for each in minutes if each.at_s > HOUR_S]
    if base_mb is None or len(later) < _ABOUT_S / 60:
        return Check(what, passed=True, found="shorter than an hour and ten minutes: not asked")
    spans: dict[int, list[float]] = {}
    for each in later:
        spans.setdefault(int(each.at_s / _ABOUT_S), []).append(each.resident_mb)
    grown_mb = max(median(each) for each in spans.values()) - base_mb
    end_mb = later[-1].resident_mb - base_mb
    return Check(what, grown_mb <= limits.memory_mb, f"{grown_mb:+.1f} MB at most, {end_mb:+.1f} MB at the end")


def memory_told(minutes: Sequence[Minute], starts: Sequence[Start]) -> str:
    """What memory grew by after the first hour, apart: what programs left behind, and what knowledge takes.

    Empty for a soak that has not had an hour and two programs.
    """
    base_mb = memory_base_mb(minutes)
    first = [each.left_mb for each in starts if each.at_s + each.lasted_s <= HOUR_S]
    if base_mb is None or not first or len(first) == len(starts):
        return ""
    then = next(each for each in minutes if each.at_s > HOUR_S - _ABOUT_S / 2)
    now = minutes[-1]
    end_mb = median(each.resident_mb for each in minutes[-10:]) - base_mb
    left_mb = starts[-1].left_mb - first[-1]
    lessons, rlas = now.lessons - then.lessons, now.rlas - then.rlas
    each_kb = f", {(end_mb - left_mb) * 1000 / lessons:.1f} kB for each lesson" if lessons > 0 else ""
    return (
        f"Of {end_mb:+.1f} MB since the first hour {left_mb:+.1f} MB stay when the program ends, after "
        f"{len(starts) - len(first)} more starts; {end_mb - left_mb:+.1f} MB are for what it knows: "
        f"{lessons:+d} lessons and {rlas:+d} RLAs{each_kb}."
    )


def steady_check(minutes: Sequence[Minute]) -> Check:
    """As many files and threads at the end as after the first minutes."""
    what = "open files and threads do not become more"
    if len(minutes) < 2:
        return Check(what, passed=True, found="shorter than two minutes: not asked")
    first, last = minutes[0], minutes[-1]
    # At the full minute something may be open that is not for long, so the least of the last ten counts.
    files = min(each.open_files for each in minutes[-10:])
    alive = min(each.threads for each in minutes[-10:])
    found = f"{first.open_files} files and {first.threads} threads first, {files} and {alive} at the end"
    return Check(what, files <= first.open_files and alive <= first.threads and last.at_s > first.at_s, found)


def fault_check(faults: Sequence[FaultSeen]) -> Check:
    """Each fault led to the standstill that it must lead to."""
    wrong = [each for each in faults if each.complaint]
    drove = sum(each.drove for each in faults)
    found = f"{len(faults)} faults, {drove} of them while it drove; {len(wrong)} not as they must"
    return Check("every fault leads to what it must", not wrong, found)


def starts_check(starts: Sequence[Start], unexpected: Sequence[str]) -> Check:
    """The program ended only where a fault must end it, and left every lesson."""
    wrong = [each for each in starts if each.complaint]
    ended = sum(bool(each.ended_by) for each in starts)
    found = (
        f"{len(starts)} starts, {ended} ended by a fault; {len(unexpected)} unexpected ends, {len(wrong)} lost lessons"
    )
    return Check(
        "every lesson is kept over every start, and nothing ends the program that must not",
        not (wrong or unexpected),
        found,
    )


def envelope_check(complaints: Complaints, frames: int) -> Check:
    """Nothing that the witness of every tick complained about."""
    return Check(
        "the motion envelope holds, the robot stands until it is told to drive, and every tick is accounted for",
        complaints.count == 0,
        f"{complaints.count} complaints about {frames} frames",
    )
