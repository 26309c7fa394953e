"""Tables of the study of broken sensors."""

import math
from collections.abc import Iterator, Sequence
from statistics import median

from kurt2rt.experiments.broken.outcome import FaultDrive, HealthyOutcome
from kurt2rt.experiments.broken.plan import BrokenStudy
from kurt2rt.experiments.lockstep.report import wilson_interval
from kurt2rt.experiments.study.intervals import difference_of, poisson_interval
from kurt2rt.experiments.study.table import Table

SOON_S = 10.0
"""Time of driving within which a fault is to be noticed, in s."""
MISLED_S = 1.0
"""Time of misleading readings from which on a fault matters, in s."""


def all_tables(study: BrokenStudy) -> Iterator[Table]:
    """Yield all tables: notices, collisions, sensors and working sensors."""
    if study.sensors:
        yield noticed_table(study)
        yield collision_table(study)
        yield sensor_table(study)
    if study.healthy:
        yield healthy_table(study)


def noticed_table(study: BrokenStudy) -> Table:
    """Return how many faults were noticed, and how soon, by kind of fault."""
    rows = []
    for name, drives in _by_fault(study):
        soon = sum(_soon(each) for each in drives)
        matters = [each for each in drives if each.misled_s >= MISLED_S]
        times = [each.driven_s for each in drives if each.noticed]
        rows.append(
            (
                name,
                _share(sum(bool(each.noticed) for each in drives), len(drives)),
                _share(soon, len(drives)),
                _share(sum(_soon(each) for each in matters), len(matters)),
                f"{median(times):.1f}" if times else "",
                f"{max(times):.1f}" if times else "",
                str(sum(each.asks > 0 and not each.noticed for each in drives)),
                str(sum(len(each.wrong) for each in drives)),
            )
        )
    return Table(
        f"Faults of single sensors that were noticed, {len(study.plan.drives.seeds)} robots",
        (
            *("fault", "noticed", f"within {SOON_S:g} s", "of those that mislead"),
            *("median s", "longest s", "asks instead", "wrong sensor named"),
        ),
        tuple(rows),
        note=f"In s of driving with the fault, at most {study.plan.drives.longest_s:g} s; with 95 % intervals. A fault "
        f"misleads if the reading is far from a working sensor's for {MISLED_S:g} s of that driving. Asks instead: it "
        "was not noticed, and the robot stood in a situation that it does not know.",
    )


def collision_table(study: BrokenStudy) -> Table:
    """Return the collisions of robot and policy with the same fault from the same start, by kind of fault."""
    rows = []
    for name, drives in _by_fault(study):
        kind = name if name != _ALL else None
        until = [[each.collisions_before - each.policy_before for each in robot] for robot in _by_robot(study, kind)]
        whole = [
            [each.collisions_before + each.collisions_after - each.policy_collisions for each in robot]
            for robot in _by_robot(study, kind)
        ]
        stands = sum(each.collisions_before for each in drives)
        rows.append(
            (
                name,
                str(len(drives)),
                str(stands),
                str(sum(each.policy_before for each in drives)),
                _difference(until),
                str(sum(each.collisions_after for each in drives)),
                f"{sum(each.after_s for each in drives) / 60:.0f}",
                str(sum(each.policy_collisions for each in drives)),
                _difference(whole),
            )
        )
    return Table(
        "Collisions with the fault",
        (
            *("fault", "drives", "until the notice", "policy until then", "more than the policy"),
            *("after Go", "minutes after Go", "policy, whole drive", "whole drive: more than the policy"),
        ),
        tuple(rows),
        note="The policy drives from the same start with the same fault for the same time, without a check. A robot "
        "that stands at the notice has the collisions until then. Differences: mean of the robots, with 95 % "
        "intervals (bootstrap over robots).",
    )


def sensor_table(study: BrokenStudy) -> Table:
    """Return, for each sensor, how many drives with each fault were noticed in time, and its collisions."""
    faults = study.plan.drives.faults
    rows = []
    for name in dict.fromkeys(each.sensor for each in study.sensors):
        outcomes = [each for each in study.sensors if each.sensor == name]
        drives = [drive for each in outcomes for drive in each.drives]
        cells = []
        for fault in faults:
            of_fault = [each for each in drives if each.fault is fault]
            cells.append(f"{sum(_soon(each) for each in of_fault)} of {len(of_fault)}")
        rows.append(
            (
                name,
                *cells,
                str(sum(each.collisions_before for each in drives)),
                str(sum(each.collisions_after for each in drives)),
                str(sum(each.policy_collisions for each in drives)),
            )
        )
    return Table(
        f"Each sensor: noticed within {SOON_S:g} s of driving, and collisions",
        ("sensor", *(fault.value for fault in faults), "until the notice", "after Go", "policy"),
        tuple(rows),
    )


def healthy_table(study: BrokenStudy) -> Table:
    """Return the working sensors that were named as broken, by driver and kind of world."""
    groups: dict[tuple[str, str], list[HealthyOutcome]] = {}
    for job, outcome in zip(study.plan.healthy_jobs, study.healthy, strict=True):
        groups.setdefault((outcome.driver, job.place), []).append(outcome)
        groups.setdefault((outcome.driver, _ALL), []).append(outcome)
    rows = []
    for (driver, place), outcomes in sorted(groups.items()):
        hours = sum(each.driven_s for each in outcomes) / 3600
        named = [name for each in outcomes for name in each.named]
        low, high = poisson_interval(len(named))
        rows.append(
            (
                driver,
                place,
                f"{60 * hours:.1f}",
                str(len(named)),
                f"{len(named) / hours:.1f} ({low / hours:.1f} to {high / hours:.1f})",
                ", ".join(sorted(set(named))),
            )
        )
    return Table(
        "Working sensors that were named as broken",
        ("driver", "world", "minutes driven", "named", "in an hour", "sensors"),
        tuple(rows),
        words=2,
        note="Presses: each action of the repertoire for 4 s, whatever is in the way. 95 % intervals: Poisson.",
    )


_ALL = "all"


def _soon(drive: FaultDrive) -> bool:
    return bool(drive.noticed) and drive.driven_s <= SOON_S


def _by_fault(study: BrokenStudy) -> Iterator[tuple[str, list[FaultDrive]]]:
    drives = [drive for each in study.sensors for drive in each.drives]
    for fault in study.plan.drives.faults:
        yield fault.value, [each for each in drives if each.fault is fault]
    yield _ALL, drives


def _by_robot(study: BrokenStudy, fault: str | None) -> list[list[FaultDrive]]:
    """Return the drives of each robot, with one kind of fault or with all."""
    return [
        [
            drive
            for each in study.sensors
            if each.seed == seed
            for drive in each.drives
            if fault is None or drive.fault.value == fault
        ]
        for seed in study.plan.drives.seeds
    ]


def _difference(more: Sequence[Sequence[int]]) -> str:
    """Return the mean sum of the robots with its interval; `more`: differences of each robot's drives."""
    found = difference_of([float(sum(robot)) for robot in more])
    if math.isinf(found.low):
        return f"{found.value:+.1f}"
    return f"{found.value:+.1f} ({found.low:+.1f} to {found.high:+.1f})"


def _share(count: int, of: int) -> str:
    if not of:
        return "none"
    return "{} of {} ({:.0%} to {:.0%})".format(count, of, *wilson_interval(count, of))
