"""Tables of a search: the best trials, and the check."""

from collections.abc import Mapping, Sequence
from statistics import fmean

from kurt2rt.experiments.search.check import CheckResult, best_trials
from kurt2rt.experiments.search.jobs import SHIPPED, label_of
from kurt2rt.experiments.search.journal import TrialJournal, finished
from kurt2rt.experiments.search.plan import SearchPlan
from kurt2rt.experiments.search.score import PRESSES_OF_A_COLLISION, RobotScore, effort
from kurt2rt.experiments.search.settings import Objective
from kurt2rt.experiments.search.space import Values
from kurt2rt.experiments.study.intervals import RateDifference
from kurt2rt.experiments.study.table import Table

_SHOWN = 5
_EFFORT: Mapping[Objective, str] = {
    "passed_then_presses": "presses",
    "passed_then_presses_and_collisions": f"presses and {PRESSES_OF_A_COLLISION} times collisions",
    "passed_then_rlas": "RLAs",
}


def all_tables(plan: SearchPlan, journal: TrialJournal, check: CheckResult) -> list[Table]:
    """Return the tables of a finished search."""
    return [_trials_table(plan, journal, check.record.trials), _check_table(plan, check)]


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


def _trials_table(plan: SearchPlan, journal: TrialJournal, count: int) -> Table:
    search, trials = plan.search, journal.trials[:count]
    keys = tuple(each.key for each in search.space)
    shown = [*best_trials(trials, _SHOWN, plan.space.shipped), trials[0]]
    rows = []
    for trial in shown:
        jobs = plan.jobs.trial(trial.params, trial.number)
        robots = [job.score(plan.jobs.parts["results"]) for job in jobs]
        name = SHIPPED if trial.params == plan.space.shipped else label_of(trial.number)
        rows.append((name, *_cells(robots, search.objective), *_values(trial.params, keys)))
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


def _cells(robots: Sequence[RobotScore], objective: Objective) -> tuple[str, str]:
    passed, exams = sum(each.passed for each in robots), sum(each.exams for each in robots)
    of_robot = fmean(effort(each, objective) for each in robots)
    return f"{passed} of {exams}", f"{of_robot:.1f}"


def _values(values: Values, keys: Sequence[str]) -> tuple[str, ...]:
    return tuple(f"{values[key]:g}" for key in keys)


def _difference(difference: RateDifference, factor: float = 1.0) -> str:
    value, low, high = (factor * each for each in difference)
    return f"{value:+.1f} ({low:+.1f} to {high:+.1f})"
