"""The tables of the results."""

import statistics
from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import ceil

from behaviors.metrics.errands import ErrandsSettings
from kurt2rt.core.teacher_settings import SUPERHUMAN
from kurt2rt.experiments.lockstep.report import wilson_interval
from kurt2rt.experiments.navigation.outcome import ErrandDone, ErrandsOutcome, ErrandsRun, Strategy
from kurt2rt.experiments.navigation.robot_day import CONTROLS, PLANNING
from kurt2rt.experiments.study.eligibility import reasons_against_judging
from kurt2rt.experiments.study.table import Table

SHARE = 18 / 20
"""Required ratio of goals reached by a way that is short enough, and of robots that reach this ratio."""

_TITLES: dict[Strategy, str] = {
    "planning": "by a plan",
    "chance": "control: any way taught, by chance",
    "first taught": "control: always the way taught first",
}


def all_tables(
    outcomes: Sequence[ErrandsOutcome], course: ErrandsSettings, teacher: str = SUPERHUMAN
) -> Iterator[Table]:
    """Yield all tables of the outcomes, one outcome per robot.

    `course`: settings of the errands. `teacher`: name of the scripted teacher.
    """
    yield targets_table(outcomes, course)
    runs = runs_table(outcomes, course)
    yield replace(runs, note=f"{runs.note} Taught by the scripted teacher {teacher}.")
    yield robots_table(outcomes, course)


def targets_table(outcomes: Sequence[ErrandsOutcome], course: ErrandsSettings) -> Table:
    """Return the table of requirements and measured values, over all robots. `course`: settings of the errands."""
    runs = _runs(outcomes, "planning")
    goals = sum(len(run.errands) for run in runs)
    good = sum(run.good(course.detour_at_most) for run in runs)
    enough = sum(_is_enough(run, course) for run in runs)
    needed, robots = ceil(SHARE * goals - 1e-9), ceil(SHARE * len(runs) - 1e-9)
    reached = [each for run in runs for each in run.reached]
    mean = statistics.fmean(each.detour for each in reached) if reached else float("inf")
    rows = (
        (
            f"goals reached, way at most {course.detour_at_most:g} times the shortest",
            f"{needed} of {goals}",
            f"{good} of {goals}",
            good >= needed,
        ),
        (
            "robots that reach so 18 of 20 of their goals",
            f"{robots} of {len(runs)}",
            f"{enough} of {len(runs)}",
            enough >= robots,
        ),
        (
            "way to goals that were reached, mean",
            f"at most {course.detour_at_most:g} times the shortest",
            f"{mean:.2f}",
            mean <= course.detour_at_most,
        ),
    )
    reasons = list(reasons_against_judging([each.seed for each in outcomes]))
    told = tuple((what, asked, came, "not judged" if reasons else _word(met)) for what, asked, came, met in rows)
    return Table(
        "Errands: what was asked",
        ("what", "asked", "came", "verdict"),
        told,
        words=4,
        note=" ".join(["Not judged.", *reasons]) if reasons else "",
    )


def runs_table(outcomes: Sequence[ErrandsOutcome], course: ErrandsSettings) -> Table:
    """Return the table of the drives by planning and of the controls. `course`: settings of the errands."""
    rows = []
    for how in (*PLANNING, *CONTROLS):
        runs = _runs(outcomes, how)
        errands = [each for run in runs for each in run.errands]
        if not errands:
            continue
        good = sum(run.good(course.detour_at_most) for run in runs)
        low, high = wilson_interval(good, len(errands))
        detours = [each.detour for run in runs for each in run.reached]
        rows.append(
            (
                _TITLES[how],
                f"{good} of {len(errands)}",
                f"{low:.0%} to {high:.0%}",
                str(len(detours)),
                f"{statistics.fmean(detours):.2f}" if detours else "",
                f"{max(detours):.2f}" if detours else "",
                str(sum(each.surprises for each in errands)),
                str(sum(each.collisions for each in errands)),
            )
        )
    replayed = [each for run in _runs(outcomes, "planning") for each in run.errands]
    never = sum(each.demonstrated is None for each in replayed)
    led = [each.demonstrated for each in replayed if each.demonstrated is not None]
    shown = f"mean {statistics.fmean(led):.1f}, least {min(led):.2f} times the shortest" if led else "none"
    return Table(
        "Goals that were never demonstrated as a whole",
        ("how", "reached in time", "95 %", "reached", "way / shortest", "most", "surprises", "collisions"),
        tuple(rows),
        words=1,
        note=f"Reached in time: without touching anything, by a way of at most {course.detour_at_most:g} times the "
        f"shortest. Who repeats the shortest piece of the lesson that leads from start to goal: {shown}; for {never} "
        "goals there is no such piece.",
    )


def robots_table(outcomes: Sequence[ErrandsOutcome], course: ErrandsSettings) -> Table:
    """Return the table of single robots, a row for each. `course`: settings of the errands."""
    rows = []
    for each in outcomes:
        run = each.run_of("planning")
        assert run is not None
        why = ", ".join(f"{failed.goal}: {_why(failed.why_not, failed.collisions)}" for failed in _failed(run))
        rows.append(
            (
                str(each.seed),
                f"{each.teaching_s:.0f}",
                f"{each.ways} of {each.ways_in_all}",
                str(each.mid_rlas),
                str(each.mid_asks),
                str(each.missed_junctions),
                str(each.rescues),
                f"{run.good(course.detour_at_most)} of {len(run.errands)}",
                why or "none",
            )
        )
    return Table(
        "Each robot",
        ("robot", "led, s", "ways", "mid-level RLAs", "asks", "missed", "rescues", "reached", "not reached"),
        tuple(rows),
        words=1,
    )


def _why(why_not: str, collisions: int) -> str:
    return why_not or f"{collisions} collision{'' if collisions == 1 else 's'}"


def _failed(run: ErrandsRun) -> Iterator[ErrandDone]:
    return (each for each in run.errands if not each.reached)


def _runs(outcomes: Sequence[ErrandsOutcome], how: Strategy) -> list[ErrandsRun]:
    return [run for each in outcomes if (run := each.run_of(how)) is not None]


def _is_enough(run: ErrandsRun, course: ErrandsSettings) -> bool:
    return len(run.errands) > 0 and run.good(course.detour_at_most) >= SHARE * len(run.errands) - 1e-9


def _word(met: bool) -> str:
    return "met" if met else "missed"
