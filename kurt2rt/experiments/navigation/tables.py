"""Tables and figure of the navigation study."""

import statistics
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from matplotlib.figure import Figure

from behaviors.metrics.errands import ErrandsSettings
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teacher_settings import SUPERHUMAN
from kurt2rt.experiments.lockstep.trails import draw_trail
from kurt2rt.experiments.navigation.guided_tour import navigation_settings
from kurt2rt.experiments.navigation.study import ErrandsOutcome, NavigationJob
from kurt2rt.experiments.navigation.tour_guide import HOME
from kurt2rt.experiments.study.figures import START, save
from kurt2rt.experiments.study.study_plan import StudyPlan
from kurt2rt.experiments.study.table import Table, Told, collisions_text, of_text, share_text, table_of
from kurt2rt.experiments.study.targets import Verdict, needed_of, reasons_against_judging, targets_table
from simbridge.contracts.simulation import SimulationFactory

SHARE = 18 / 20
"""Required ratio of goals reached by a way that is short enough, and of robots that reach this ratio."""
_LED = "#b0b0b0"
_BOX = {"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": _LED, "linewidth": 0.6}


def tell(plan: StudyPlan[TaskSettings]) -> Told:
    """Draw each robot into the folder of the results; return the tables. Raises StudyError, OSError."""
    task, outcomes = plan.about, [job.results.read(job, ErrandsOutcome) for job in plan.of(NavigationJob)]
    pictures = [plan.results.folder / f"{task.name}-{outcome.seed}.png" for outcome in outcomes]
    for outcome, path in zip(outcomes, pictures, strict=True):
        draw_errands(plan.jobs[0].factory, task.exam.worlds[0], outcome, path)
    tables = list(all_tables(outcomes, navigation_settings(task), task.teaching.profile.name))
    return Told(tables, (), {"pictures": plan.results.folder}, (), {"pictures": pictures})


def all_tables(
    outcomes: Sequence[ErrandsOutcome], metric: ErrandsSettings, teacher: str = SUPERHUMAN
) -> Iterator[Table]:
    """Yield all tables of the outcomes, one outcome per robot.

    `metric`: settings of the errands. `teacher`: name of the scripted teacher.
    """
    reasons = list(reasons_against_judging([each.seed for each in outcomes]))
    found = [((), verdict) for verdict in verdicts(outcomes, metric)]
    yield targets_table(found, reasons, title="Errands: what was asked")
    yield _runs_table(outcomes, metric, teacher)
    yield _robots_table(outcomes, metric)


def verdicts(runs: Sequence[ErrandsOutcome], metric: ErrandsSettings) -> Iterator[Verdict]:
    """Yield the verdicts on the drives of all robots by a plan. `metric`: settings of the errands."""
    most, goals = metric.detour_at_most, sum(len(run.errands) for run in runs)
    good, needed = sum(run.good(most) for run in runs), needed_of(SHARE, goals)
    what = f"goals reached, way at most {most:g} times the shortest"
    yield Verdict(what, of_text(needed, goals), of_text(good, goals), good >= needed)
    robots = needed_of(SHARE, len(runs))
    enough = sum(bool(run.errands) and run.good(most) >= needed_of(SHARE, len(run.errands)) for run in runs)
    asked, came = of_text(robots, len(runs)), of_text(enough, len(runs))
    yield Verdict("robots that reach so 18 of 20 of their goals", asked, came, enough >= robots)
    mean = _mean(each.detour for run in runs for each in run.reached)
    asked = f"at most {most:g} times the shortest"
    yield Verdict("way to goals that were reached, mean", asked, f"{mean:.2f}", mean <= most)


def _runs_table(outcomes: Sequence[ErrandsOutcome], metric: ErrandsSettings, teacher: str) -> Table:
    errands = [each for run in outcomes for each in run.errands]
    good, detours = sum(run.good(metric.detour_at_most) for run in outcomes), [e.detour for e in errands if e.reached]
    led = [each.demonstrated for each in errands if each.demonstrated is not None]
    shown = f"mean {_mean(led):.1f}, least {min(led):.2f} times the shortest" if led else "none"
    return table_of(
        "Goals that were never demonstrated as a whole",
        [outcomes] if errands else [],
        ("reached in time", lambda _: of_text(good, len(errands))),
        ("95 %", lambda _: share_text(good, len(errands))),
        ("reached", lambda _: len(detours)),
        ("way / shortest", lambda _: f"{_mean(detours):.2f}" if detours else ""),
        ("most", lambda _: f"{max(detours):.2f}" if detours else ""),
        ("surprises", lambda _: sum(each.surprises for each in errands)),
        ("collisions", lambda _: sum(each.collisions for each in errands)),
        words=0,
        note=f"Reached in time: without touching anything, by a way of at most {metric.detour_at_most:g} times the "
        f"shortest. Who repeats the shortest piece of the lesson that leads from start to goal: {shown}; for "
        f"{len(errands) - len(led)} goals there is no such piece. Taught by the scripted teacher {teacher}.",
    )


def _robots_table(outcomes: Sequence[ErrandsOutcome], metric: ErrandsSettings) -> Table:

    def missed(each: ErrandsOutcome) -> str:
        failed = (done for done in each.errands if not done.reached)
        return (
            ", ".join(f"{done.goal}: {done.why_not or collisions_text(done.collisions)}" for done in failed) or "none"
        )

    return table_of(
        "Each robot",
        outcomes,
        ("robot", lambda each: each.seed),
        ("led, s", lambda each: f"{each.teaching_s:.0f}"),
        ("ways", lambda each: of_text(each.ways, each.ways_in_all)),
        ("mid-level RLAs", lambda each: each.mid_rlas),
        ("asks", lambda each: each.mid_asks),
        ("missed", lambda each: each.missed_junctions),
        ("rescues", lambda each: each.rescues),
        ("reached", lambda each: of_text(each.good(metric.detour_at_most), len(each.errands))),
        ("not reached", missed),
    )


def _mean(values: Iterable[float]) -> float:
    """Return the mean; infinite without values."""
    given = list(values)
    return statistics.fmean(given) if given else float("inf")


def draw_errands(factory: SimulationFactory, world: str, outcome: ErrandsOutcome, path: Path) -> None:
    """Draw the tour and the drives of one robot in a world, and write the picture to `path`. Raises OSError."""
    figure = Figure(figsize=(7.2, 8.0), layout="constrained")
    axes = figure.subplots()
    factory.draw(axes, world)
    label = f"led about, {outcome.teaching_s:.0f} s"
    axes.plot([x for x, _ in outcome.led], [y for _, y in outcome.led], color=_LED, lw=0.8, zorder=2, label=label)
    goals = len(outcome.errands)
    draw_trail(axes, outcome.trail, f"errands without a teacher, {goals} goals", width=0.9)
    meant = {each.goal: each.reached for each in outcome.errands}
    for name, (x_m, y_m) in outcome.named.items():
        if name == HOME:
            axes.plot([x_m], [y_m], "s", color=START, fillstyle="none", mew=2.0, ms=9, zorder=6, label=HOME)
        else:
            weight = "bold" if name in meant else "normal"
            number = name.rsplit(" ", 1)[-1]
            axes.annotate(
                number, (x_m, y_m), ha="center", va="center", fontsize="x-small", weight=weight, zorder=7, bbox=_BOX
            )
    axes.set_title(
        f"robot {outcome.seed}: {len(outcome.reached)} of {goals} goals reached\n"
        f"{outcome.ways} of {outcome.ways_in_all} ways taught in {outcome.teaching_s:.0f} s",
        fontsize="medium",
    )
    figure.legend(loc="outside lower center", ncols=3, fontsize="small", frameon=False)
    save(figure, path)
