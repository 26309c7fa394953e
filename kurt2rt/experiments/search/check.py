"""Check of the best trials on other robots and worlds, once, against the shipped settings on the same robots."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from optuna.trial import FrozenTrial
from pydantic import ValidationError

from config.settings import Settings
from kurt2rt.experiments.search.plan import SHIPPED, SearchPlan, effort, label_of, score_of
from kurt2rt.experiments.search.settings import Objective
from kurt2rt.experiments.search.space import Values
from kurt2rt.experiments.search.trials import SearchTrials, finished
from kurt2rt.experiments.study.intervals import Rate, difference_of
from kurt2rt.experiments.study.jobs import ExaminedOutcome
from kurt2rt.experiments.study.pool import Executor, PoolProgress, missing_time_s, run_missing
from kurt2rt.experiments.study.results import StudyError
from kurt2rt.knowledge.journal.writer import utc_now
from kurt2rt.platform.durable_files import write_durably

_FILE = "check.json"


class CheckRecord(Settings):
    """Trials that are checked, written down before the check begins."""

    trials: int
    """Number of trials that the best ones were chosen among."""
    candidates: tuple[int, ...]
    """Numbers of the best trials, the best first."""
    date: str


@dataclass(frozen=True, slots=True)
class CheckedSettings:
    """Settings of one trial, compared with the shipped ones on the same robots."""

    label: str
    values: Values
    robots: tuple[ExaminedOutcome, ...]
    passed: Rate
    """Difference of the share of exams passed; positive is better."""
    effort: Rate
    """Difference of a robot's effort (`effort`); negative is better."""

    @property
    def is_better(self) -> bool:
        """True if more exams are passed, or no fewer with less effort, by the whole interval."""
        return self.passed.low > 0.0 or (self.passed.low >= 0.0 and self.effort.high < 0.0)


@dataclass(frozen=True, slots=True)
class CheckResult:
    """Result of a check: scores of the shipped and of the found settings, robot by robot."""

    record: CheckRecord
    shipped: tuple[ExaminedOutcome, ...]
    checked: tuple[CheckedSettings, ...]
    objective: Objective

    @property
    def found(self) -> CheckedSettings | None:
        """Settings that are better than the shipped ones; None if these stay."""
        better = [each for each in self.checked if each.is_better]
        return max(better, key=lambda each: score_of(each.robots, self.objective), default=None)


def require_unchecked(plan: SearchPlan, trials: int) -> CheckRecord | None:
    """Return the record of a check in the folder of the search, None without one; refuse more trials after it.

    A second check on the same seeds would choose by them. Raises StudyError for them, and for a damaged record.
    """
    path = plan.folder / _FILE
    if not path.exists():
        return None
    try:
        record = CheckRecord.model_validate_json(path.read_bytes())
    except ValidationError as error:
        raise StudyError("is not the record of a check", where=path, do="give a new folder with --out") from error
    if record.trials != trials:
        raise StudyError(
            f"was checked after {record.trials} trials (got --trials {trials}, allowed {record.trials})",
            where=plan.folder,
            do="give a new folder with --out, and a search with other seeds for its check",
        )
    return record


def _begin_check(plan: SearchPlan, found: SearchTrials, trials: int) -> CheckRecord:
    """Write down which of the first `trials` trials are checked; they never change. Raises StudyError, OSError."""
    record = require_unchecked(plan, trials)
    if record is None:
        best = best_trials(found.all[:trials], plan.check.best, plan.space.shipped)
        record = CheckRecord(trials=trials, candidates=tuple(trial.number for trial in best), date=utc_now())
        write_durably(plan.folder / _FILE, record.model_dump_json() + "\n")
    return record


def best_trials(trials: Sequence[FrozenTrial], count: int, shipped: Values) -> list[FrozenTrial]:
    """Return the trials with the highest scores, without the shipped settings; the earlier of equal ones first."""
    others = [trial for trial in finished(trials) if trial.params != shipped]
    return sorted(others, key=lambda trial: (-(trial.value or 0.0), trial.number))[:count]


def check_time_s(plan: SearchPlan) -> float:
    """Return the robot time of the whole check, in s."""
    sets = plan.check.best + 1
    return sets * sum(job.robot_time_s for job in plan.check_jobs(plan.space.shipped, SHIPPED))


def run_check(
    plan: SearchPlan,
    found: SearchTrials,
    trials: int,
    executor: Executor,
    on_progress: Callable[[PoolProgress], None],
) -> CheckResult:
    """Write down the best of `trials` trials, teach and examine all robots of the check, and compare.

    Robots that have a result are not taught again. `on_progress` gets the robot time of the check. Raises StudyError
    for results of other settings, and any error of a job.
    """
    results, record = plan.parts["results"], _begin_check(plan, found, trials)
    sets = {SHIPPED: plan.space.shipped, **{label_of(each): found.values(each) for each in record.candidates}}
    jobs = {label: plan.check_jobs(values, label) for label, values in sets.items()}
    checked_jobs = tuple(job for of_label in jobs.values() for job in of_label)
    whole_s = sum(job.robot_time_s for job in checked_jobs)
    done_s = whole_s - missing_time_s([checked_jobs], results)
    wave = (*checked_jobs, *plan.witnesses_of_check(checked_jobs))

    def update(told: PoolProgress) -> None:
        on_progress(told._replace(done_s=min(whole_s, done_s + told.done_s)))

    run_missing([wave], results, executor, update)
    robots = {label: tuple(job.read() for job in of_label) for label, of_label in jobs.items()}
    shipped, objective = robots.pop(SHIPPED), plan.search.objective
    checked = tuple(
        compare(label, sets[label], own, shipped, objective, len(record.candidates)) for label, own in robots.items()
    )
    return CheckResult(record, shipped, checked, objective)


def compare(
    label: str,
    values: Values,
    robots: tuple[ExaminedOutcome, ...],
    shipped: Sequence[ExaminedOutcome],
    objective: Objective,
    comparisons: int,
) -> CheckedSettings:
    """Return the comparison with the shipped settings, robot by robot; the intervals of all hold together with 95 %."""
    pairs = list(zip(robots, shipped, strict=True))
    return CheckedSettings(
        label,
        values,
        robots,
        difference_of(
            [own.passed / len(own.drives) - other.passed / len(other.drives) for own, other in pairs], comparisons
        ),
        difference_of([float(effort(own, objective) - effort(other, objective)) for own, other in pairs], comparisons),
    )
