"""Trials of a search, robots one after the other, with early ends; then one check of the best trials.

All of it follows from the stored results of the robots, so an interrupted search makes the same trials again.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import median

import optuna
from optuna.distributions import BaseDistribution, FloatDistribution
from optuna.study import Study
from optuna.trial import FrozenTrial, Trial, TrialState, create_trial
from pydantic import ValidationError

from config.settings import Settings
from kurt2rt.experiments.search.plan import SHIPPED, SearchPlan, effort, highest_score, label_of, score_of
from kurt2rt.experiments.search.settings import Objective, Values, rounded
from kurt2rt.experiments.study.intervals import Rate, difference_of
from kurt2rt.experiments.study.jobs import ExaminedOutcome, StudyError
from kurt2rt.experiments.study.pool import Executor, PoolProgress, missing_time_s, run_missing
from kurt2rt.knowledge.journal.writer import utc_now
from kurt2rt.platform.durable_files import write_durably

_STARTUP_TRIALS = 10
"""Trials with random values, before a model of the earlier ones chooses."""
_PRUNES_AFTER_TRIALS = 4


class SearchTrials:
    """Trials of a search. The same search gives the same next trial after the same trials."""

    def __init__(self, plan: SearchPlan) -> None:
        optuna.logging.set_verbosity(optuna.logging.WARNING)
        self._dimensions = {each.key: each for each in plan.search.space}
        self._distributions: dict[str, BaseDistribution] = {
            each.key: FloatDistribution(each.low, each.high, log=each.log) for each in plan.search.space
        }
        self._seed = plan.search.sampler_seed
        self._shipped = plan.space.shipped
        self.study: Study = optuna.create_study(direction="maximize")

    @property
    def all(self) -> list[FrozenTrial]:
        """All trials of the search, in the order of their numbers."""
        return self.study.get_trials(deepcopy=False)

    def begin(self, number: int) -> None:
        """Begin the trial of the next number: with the shipped values, later with those that a model chooses.

        The model learns from all trials so far; each trial has a random stream of its own.
        """
        chosen = dict(self._shipped)
        if number:
            sampler = optuna.samplers.TPESampler(seed=self._seed * 100_000 + number, n_startup_trials=_STARTUP_TRIALS)
            study: Study = optuna.create_study(sampler=sampler, direction="maximize")
            study.add_trials(self.all)
            values = study.ask(self._distributions).params
            chosen = {key: rounded(each, values[key]) for key, each in self._dimensions.items()}
        running = create_trial(state=TrialState.RUNNING, params=chosen, distributions=self._distributions)
        self.study.add_trial(running)

    def median_score(self, first: int) -> float:
        """Return the median score of the finished trials before number `first`; -inf if they are too few to prune by.

        The score is dimensionless.
        """
        scores = [trial.value for trial in finished(self.all[:first]) if trial.value is not None]
        return median(scores) if len(scores) >= _PRUNES_AFTER_TRIALS else -math.inf


def finished(trials: Sequence[FrozenTrial]) -> list[FrozenTrial]:
    """Return the trials that have a score; pruned ones and those under way have none."""
    return [trial for trial in trials if trial.state is TrialState.COMPLETE]


def trials_time_s(plan: SearchPlan, trials: int) -> float:
    """Return the robot time of all trials if none is pruned, in s."""
    return trials * sum(job.robot_time_s for job in plan.trial_jobs(plan.space.shipped, 0))


def run_trials(
    plan: SearchPlan, trials: int, executor: Executor, on_progress: Callable[[PoolProgress], None]
) -> SearchTrials:
    """Run so many trials, and return them; robots that have a result are not taught again.

    The values of a trial do not depend on the number of processes. `on_progress` gets the robot time of all trials; a
    pruned one counts as whole. Raises StudyError for results of other settings, and any error of a job.
    """
    found, at_once, trial_s = SearchTrials(plan), plan.search.at_once, trials_time_s(plan, 1)
    for first in range(0, trials, at_once):
        numbers = list(range(first, min(first + at_once, trials)))
        for number in numbers:
            found.begin(number)

        def update(progress: PoolProgress, before_s: float = first * trial_s) -> None:
            on_progress(progress._replace(done_s=before_s + progress.done_s))

        _run_together(plan, found, numbers, executor, update)
    return found


def _run_together(
    plan: SearchPlan,
    found: SearchTrials,
    numbers: list[int],
    executor: Executor,
    on_progress: Callable[[PoolProgress], None],
) -> None:
    """Run some trials, robot by robot, and prune those that cannot beat the median of the trials before them."""
    to_beat = found.median_score(numbers[0])
    jobs = {number: plan.trial_jobs(found.all[number].params, number) for number in numbers}
    robots, before_s = plan.search.search.seeds.count, 0.0
    exams = robots * len(plan.search.search.worlds)

    def robots_of(number: int, count: int) -> list[ExaminedOutcome]:
        return [job.read() for job in jobs[number][:count]]

    for step in range(robots):
        wave = tuple(jobs[number][step] for number in numbers)
        wave_s = sum(job.robot_time_s for job in wave)

        def update(progress: PoolProgress, before_s: float = before_s, wave_s: float = wave_s) -> None:
            on_progress(progress._replace(done_s=before_s + min(progress.done_s, wave_s)))

        run_missing([(*wave, *plan.witnesses_of_trials(wave))], plan.parts["results"], executor, update)
        before_s += wave_s
        for number in numbers:
            score = score_of(robots_of(number, step + 1), plan.search.objective)
            Trial(found.study, found.all[number]._trial_id).report(score, step)
        if step < robots - 1:
            hopeless = [number for number in numbers if highest_score(robots_of(number, step + 1), exams) <= to_beat]
            for number in hopeless:
                found.study.tell(number, state=TrialState.PRUNED)
            numbers = [number for number in numbers if number not in hopeless]
    for number in numbers:
        found.study.tell(number, score_of(robots_of(number, robots), plan.search.objective))


_FILE = "check.json"


class CheckRecord(Settings):
    """Choice of the trials to check, written down before the check begins, so that it is made only once."""

    trials: int
    """Number of trials that the best ones were chosen among."""
    candidates: tuple[int, ...]
    """Numbers of the best trials, the best first."""
    date: str


@dataclass(frozen=True, slots=True)
class CheckedSettings:
    """Comparison of one trial's settings with the shipped ones, robot by robot, in the check."""

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
    plan: SearchPlan, found: SearchTrials, trials: int, executor: Executor, on_progress: Callable[[PoolProgress], None]
) -> CheckResult:
    """Write down the best of `trials` trials, teach and examine all robots of the check, and compare.

    Robots that have a result are not taught again. `on_progress` gets the robot time of the check. Raises StudyError
    for results of other settings, and any error of a job.
    """
    results, record = plan.parts["results"], _begin_check(plan, found, trials)
    sets = {SHIPPED: plan.space.shipped, **{label_of(each): found.all[each].params for each in record.candidates}}
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
