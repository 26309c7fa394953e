"""Judgement of a soak's measurements."""

from collections.abc import Sequence
from statistics import median

from kurt2rt.checks.faults.complaint import Complaint
from kurt2rt.checks.soak.faults import FaultResult
from kurt2rt.checks.soak.observer import Complaints
from kurt2rt.checks.soak.result import CheckCode, SoakCheck, SoakMinute, SoakStart
from kurt2rt.checks.soak.settings import LimitSettings

HOUR_S = 3600.0
_ABOUT_S = 600.0


def memory_base_mb(minutes: Sequence[SoakMinute]) -> float | None:
    """Return the median memory of the last ten minutes of the first hour in MB; None for a shorter soak."""
    base = [each.resident_mb for each in minutes if HOUR_S - _ABOUT_S < each.at_s <= HOUR_S]
    return median(base) if base and minutes[-1].at_s > HOUR_S else None


def memory_check(minutes: Sequence[SoakMinute], limits: LimitSettings) -> SoakCheck:
    """Compare the median memory of each later ten minutes with the end of the first hour."""
    base_mb = memory_base_mb(minutes)
    later = [each for each in minutes if each.at_s > HOUR_S]
    if base_mb is None or len(later) < _ABOUT_S / 60:
        return SoakCheck(CheckCode.MEMORY, passed=True, values={"limit_mb": limits.memory_mb}, judged=False)
    spans: dict[int, list[float]] = {}
    for each in later:
        spans.setdefault(int(each.at_s / _ABOUT_S), []).append(each.resident_mb)
    grown_mb = max(median(each) for each in spans.values()) - base_mb
    end_mb = later[-1].resident_mb - base_mb
    values = {"limit_mb": limits.memory_mb, "grown_mb": grown_mb, "end_mb": end_mb}
    return SoakCheck(CheckCode.MEMORY, grown_mb <= limits.memory_mb, values)


def format_memory_growth(minutes: Sequence[SoakMinute], starts: Sequence[SoakStart]) -> str:
    """Describe the growth after the first hour: memory left by programs, and memory for knowledge.

    Empty for a soak shorter than an hour and two programs.
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


def steady_check(minutes: Sequence[SoakMinute]) -> SoakCheck:
    """Check that open files and threads at the end are no more than in the first minute."""
    if len(minutes) < 2:
        return SoakCheck(CheckCode.FILES_AND_THREADS, passed=True, values={}, judged=False)
    first, last = minutes[0], minutes[-1]
    # At the full minute something may be open that is not for long, so the least of the last ten counts.
    files = min(each.open_files for each in minutes[-10:])
    alive = min(each.threads for each in minutes[-10:])
    passed = files <= first.open_files and alive <= first.threads and last.at_s > first.at_s
    values = {"first_files": first.open_files, "first_threads": first.threads, "files": files, "threads": alive}
    return SoakCheck(CheckCode.FILES_AND_THREADS, passed, values)


def fault_check(faults: Sequence[FaultResult]) -> SoakCheck:
    """Check that each fault led to its required standstill."""
    wrong = sum(bool(each.complaints) for each in faults)
    values = {"faults": len(faults), "drove": sum(each.drove for each in faults), "wrong": wrong}
    return SoakCheck(CheckCode.FAULTS, not wrong, values)


def starts_check(starts: Sequence[SoakStart], unexpected: Sequence[Complaint]) -> SoakCheck:
    """Check that the program ended only by faults that end it, without lost lessons."""
    lost = sum(each.complaint is not None for each in starts)
    ended = sum(bool(each.ended_by) for each in starts)
    values = {"starts": len(starts), "ended": ended, "unexpected": len(unexpected), "lost": lost}
    return SoakCheck(CheckCode.STARTS, not (lost or unexpected), values)


def envelope_check(complaints: Complaints, frames: int) -> SoakCheck:
    """Check that the observer of every tick has no complaint."""
    return SoakCheck(CheckCode.ENVELOPE, complaints.count == 0, {"complaints": complaints.count, "frames": frames})
