"""Tables, figure, file of the found settings and report of a search."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from statistics import fmean
from typing import Any

import yaml
from matplotlib.axes import Axes
from optuna.trial import FrozenTrial

from kurt2rt.experiments.lockstep.trails import panels_of
from kurt2rt.experiments.search.plan import PRESSES_OF_A_COLLISION, SHIPPED, SearchPlan, effort, exams_of, label_of
from kurt2rt.experiments.search.settings import Objective, Robots
from kurt2rt.experiments.search.trials import CheckedSettings, CheckResult, SearchTrials, best_trials, finished
from kurt2rt.experiments.study.figures import SavedFigure, saved
from kurt2rt.experiments.study.intervals import Rate
from kurt2rt.experiments.study.jobs import ExaminedOutcome
from kurt2rt.experiments.study.report import Section, spans, tell_with_report
from kurt2rt.experiments.study.table import Table, Told, of_text, rate_text, table_of
from kurt2rt.platform.durable_files import write_durably

_SHOWN = 5
_DIGITS = 4
_TRIAL, _SHIPPED, _BEST, _PRUNED = "#1f6fb2", "#d1495b", "#2e8540", "#9a9a9a"
_COLUMNS = 3
_EFFORT: Mapping[Objective, str] = {
    "passed_then_presses": "presses",
    "passed_then_presses_and_collisions": f"presses and {PRESSES_OF_A_COLLISION} times collisions",
    "passed_then_rlas": "RLAs",
}


def verdict_text(plan: SearchPlan, check: CheckResult) -> str:
    """Return the result of the check in a sentence."""
    found = check.found
    if found is None:
        return "No checked trial is better than the shipped settings by its whole interval: the shipped settings stay."
    unit = _EFFORT[plan.search.objective]
    return (
        f"Trial {found.label} is better than the shipped settings: exams passed {_difference(found.passed, 100)} "
        f"percentage points, {unit} {_difference(found.effort)}."
    )


def _trials_table(plan: SearchPlan, found: SearchTrials, count: int) -> Table:
    search, trials = plan.search, found.all[:count]
    keys = tuple(each.key for each in search.space)
    shown = [*best_trials(trials, _SHOWN, plan.space.shipped), trials[0]]
    rows = []
    for trial in shown:
        robots = [job.read() for job in plan.trial_jobs(trial.params, trial.number)]
        name = SHIPPED if trial.params == plan.space.shipped else label_of(trial.number)
        rows.append((name, *_cells(robots, search.objective), *(f"{trial.params[key]:g}" for key in keys)))
    pruned = len(trials) - len(finished(trials))
    robots_text = f"{search.search.seeds.count} robots from seed {search.search.seeds.first}"
    return Table(
        f"Best trials of {len(trials)}, {pruned} pruned: {search.name}, taught by {search.teacher}",
        ("trial", "exams passed", f"{_EFFORT[search.objective]}, mean", *keys),
        tuple(rows),
        note=f"{robots_text} in {', '.join(search.search.worlds)}.",
    )


def _check_table(plan: SearchPlan, check: CheckResult) -> Table:
    search = plan.search
    unit = _EFFORT[search.objective]
    rows = [(SHIPPED, *_cells(check.shipped, search.objective), "", "")]
    for each in check.checked:
        cells = _cells(each.robots, search.objective)
        rows.append((each.label, *cells, _difference(each.passed, 100), _difference(each.effort)))
    seeds = plan.check.seeds
    return Table(
        f"Check on {seeds.count} other robots from seed {seeds.first}",
        ("trial", "exams passed", f"{unit}, mean", "passed, difference in points", f"{unit}, difference"),
        tuple(rows),
        note=f"In {', '.join(plan.check.worlds)}. Differences are paired by robot; all intervals hold together with "
        f"95 %. {verdict_text(plan, check)}",
    )


def _cells(robots: Sequence[ExaminedOutcome], objective: Objective) -> tuple[str, str]:
    passed, exams = sum(each.passed for each in robots), exams_of(robots)
    of_robot = fmean(effort(each, objective) for each in robots)
    return of_text(passed, exams), f"{of_robot:.1f}"


def _difference(difference: Rate, factor: float = 1.0) -> str:
    return rate_text(Rate(*(factor * each for each in difference)), "+.1f")


def _draw_trials(plan: SearchPlan, trials: list[FrozenTrial], path: Path) -> SavedFigure:
    """Draw the scores by number and by each key as a PNG to `path`. Raises OSError."""
    panels = 1 + len(plan.search.space)
    figure, axes = panels_of(panels, _COLUMNS, (4.4, 3.4))
    _draw_order(axes[0], trials)
    for each, dimension in zip(axes[1:], plan.search.space, strict=True):
        _draw_scores(each, [trial.params[dimension.key] for trial in trials], trials)
        each.set_xlabel(dimension.key)
        if dimension.log:
            each.set_xscale("log")
    for first in axes[::_COLUMNS]:
        first.set_ylabel("score")
    return saved(
        figure,
        path,
        "Trials",
        "Each point is a trial, the first one the shipped settings. The score is the share of exams passed, and less "
        "than half an exam more for little effort. A cross was pruned: its score is that of its first robots.",
    )


def _draw_order(axes: Axes, trials: list[FrozenTrial]) -> None:
    _draw_scores(axes, [float(trial.number) for trial in trials], trials)
    done = finished(trials)
    best = [max(trial.value or 0.0 for trial in done[: place + 1]) for place in range(len(done))]
    axes.step([trial.number for trial in done], best, where="post", color=_BEST, label="best so far")
    axes.set_xlabel("trial")
    axes.legend(fontsize="small", frameon=False)


def _draw_scores(axes: Axes, places: list[float], trials: list[FrozenTrial]) -> None:
    done = {trial.number for trial in finished(trials)}
    for place, trial in zip(places, trials, strict=True):
        score = trial.intermediate_values[trial.last_step or 0]  # of all robots, or of those before it was pruned
        colour = _PRUNED if trial.number not in done else _TRIAL if trial.number else _SHIPPED
        axes.scatter(place, score, color=colour, marker="o" if trial.number in done else "x", s=22)
    axes.grid(alpha=0.3)


def write_found(plan: SearchPlan, check: CheckResult, command: str, path: Path) -> None:
    """Write the changed keys of the task, each checked trial, and the verdict as YAML to `path`. Raises OSError."""
    search, found = plan.search, check.found
    content = {
        "study": search.name,
        "command": command,
        "date": check.record.date,
        "source": plan.made_of.source,
        "versions": plan.made_of.versions,
        "task": search.task,
        "teacher": search.teacher,
        "objective": search.objective,
        "trials": check.record.trials,
        "search": _robots_told(search.search),
        "check": _robots_told(plan.check),
        "shipped": {"values": dict(plan.space.shipped), **_counts(check.shipped, search.objective)},
        "checked": [_checked(each, check.objective) for each in check.checked],
        "verdict": verdict_text(plan, check),
        # Keys as --set takes them; empty if the shipped settings stay.
        "changes": {} if found is None else plan.space.changes(found.values),
    }
    write_durably(path, yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=120))


def _robots_told(robots: Robots) -> dict[str, Any]:
    return {"seeds": spans(robots.seeds.seeds), "worlds": list(robots.worlds)}


def _checked(each: CheckedSettings, objective: Objective) -> dict[str, Any]:
    differences = {"passed_share_difference": each.passed, "effort_difference": each.effort}
    return {
        "trial": each.label,
        "values": dict(each.values),
        **_counts(each.robots, objective),
        **{name: {end: round(x, _DIGITS) for end, x in rate._asdict().items()} for name, rate in differences.items()},
        "is_better": each.is_better,
    }


def _counts(robots: Sequence[ExaminedOutcome], objective: Objective) -> dict[str, Any]:
    passed, efforts = sum(each.passed for each in robots), [effort(each, objective) for each in robots]
    return {"passed": passed, "exams": exams_of(robots), "effort": efforts}


def tell(plan: SearchPlan, found: SearchTrials, check: CheckResult, command: str) -> Told:
    """Write figure, found settings and report into the folder of the search; return the tables. Raises OSError.

    `command`: typed words, without those that belong to the machine alone.
    """
    tables = [_trials_table(plan, found, check.record.trials), _check_table(plan, check)]
    figure = _draw_trials(plan, found.all[: check.record.trials], plan.folder / "trials.png")
    found_file = plan.folder / "found.yaml"
    write_found(plan, check, command, found_file)
    search = plan.search
    space = table_of(
        "Space",
        search.space,
        ("key", lambda each: each.key),
        ("low", lambda each: f"{each.low:g}"),
        ("high", lambda each: f"{each.high:g}"),
        ("logarithmic", lambda each: "yes" if each.log else "no"),
        ("shipped", lambda each: f"{plan.space.shipped[each.key]:g}"),
        words=2,
    )
    about = (
        f"Each trial teaches the robots of seeds {spans(search.search.seeds.seeds)} with settings of its own, by the "
        f"scripted teacher {search.teacher}, and examines them without it. A trial that cannot beat the median of the "
        "trials before it ends early. The best trials and the shipped settings are then compared once on the robots of "
        f"seeds {spans(plan.check.seeds.seeds)}, which chose nothing; checked on {check.record.date}."
    )
    better = None if check.found is None else check.found.label
    verdict = verdict_text(plan, check)
    told = Told(
        tables,
        verdict,
        (about,),
        replace(tables[1], note=""),
        files={"found": found_file},
        data={"better": better, "verdict": verdict},
    )
    title, more = f"KURT2: search for settings of {search.task}", [Section("Space", tables=(space,))]
    return tell_with_report(plan.folder, title, told, command, [figure], more)
