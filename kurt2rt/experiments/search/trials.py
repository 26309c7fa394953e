"""Runner of the trials: robots come one after the other, and a trial that cannot beat the median ends early."""

from collections.abc import Callable, Sequence

from optuna.trial import TrialState

from kurt2rt.experiments.search.journal import TrialJournal
from kurt2rt.experiments.search.plan import SearchJob, SearchPlan
from kurt2rt.experiments.search.score import RobotScore, highest_score, score_of
from kurt2rt.experiments.study.pool import PoolProgress
from kurt2rt.experiments.study.runner import Executor, run_missing


def trials_time_s(plan: SearchPlan, trials: int) -> float:
    """Return the robot time of all trials if none is pruned, in s."""
    return trials * sum(job.robot_time_s for job in plan.trial_jobs(plan.space.shipped, 0))


def run_trials(
    plan: SearchPlan,
    journal: TrialJournal,
    trials: int,
    executor: Executor,
    on_progress: Callable[[PoolProgress], None],
) -> None:
    """Run trials until there are `trials`; go on with those that an earlier run left.

    Which values a trial has does not depend on the number of processes.

    Args:
        executor: runs the jobs.
        on_progress: gets the robot time of all trials; a pruned one counts as whole.

    Raises:
        StudyError: a process was killed, or results of other settings are in the folder.
        Exception: any error of a job.
    """
    at_once = plan.search.at_once
    trial_s = trials_time_s(plan, 1)
    for first in range(0, trials, at_once):
        numbers = range(first, min(first + at_once, trials))
        for number in numbers:
            if number == len(journal.trials):
                journal.begin(number)

        def update(progress: PoolProgress, before_s: float = first * trial_s) -> None:
            on_progress(PoolProgress(before_s + progress.done_s, progress.running))

        # Of earlier trials only, so that it is the same if some of these ended before a restart.
        to_beat = journal.median_score(first)
        running = [number for number in numbers if journal.trials[number].state is TrialState.RUNNING]

        def run(wave: Sequence[SearchJob], on_wave: Callable[[PoolProgress], None]) -> None:
            whole = (*wave, *plan.witnesses_of_trials(wave))
            run_missing([whole], plan.parts["results"], executor, on_wave)

        _run_together(plan, journal, running, to_beat, run, update)


def _run_together(
    plan: SearchPlan,
    journal: TrialJournal,
    numbers: list[int],
    to_beat: float,
    run: Callable[[Sequence[SearchJob], Callable[[PoolProgress], None]], None],
    on_progress: Callable[[PoolProgress], None],
) -> None:
    """Run some trials, robot by robot, and prune those that cannot have a higher score than `to_beat`."""
    jobs = {number: plan.trial_jobs(journal.values(number), number) for number in numbers}
    robots, before_s = plan.search.search.seeds.count, 0.0
    exams = robots * len(plan.search.search.worlds)

    def scores(number: int, count: int) -> list[RobotScore]:
        return [job.score() for job in jobs[number][:count]]

    for step in range(robots):
        wave = tuple(jobs[number][step] for number in numbers)

        wave_s = sum(job.robot_time_s for job in wave)

        def update(progress: PoolProgress, before_s: float = before_s, wave_s: float = wave_s) -> None:
            on_progress(PoolProgress(before_s + min(progress.done_s, wave_s), progress.running))

        run(wave, update)
        before_s += wave_s
        for number in numbers:
            journal.report(number, step, score_of(scores(number, step + 1), plan.search.objective))
        if step < robots - 1:
            hopeless = [number for number in numbers if highest_score(scores(number, step + 1), exams) <= to_beat]
            for number in hopeless:
                journal.prune(number)
            numbers = [number for number in numbers if number not in hopeless]
    for number in numbers:
        journal.finish(number, score_of(scores(number, robots), plan.search.objective))
