"""Tuning of one rival in one task: its trials, and the best of them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from optuna.trial import FrozenTrial

from kurt2rt.experiments.rivals.tuned import GATE, TunedRival
from kurt2rt.experiments.search.journal import TrialJournal, finished
from kurt2rt.experiments.search.plan import SearchPlan, make_plan
from kurt2rt.experiments.search.trials import run_trials, trials_time_s
from kurt2rt.experiments.study.html_report import spans
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.plan import Executor
from kurt2rt.experiments.study.pool import PoolProgress
from kurt2rt.experiments.study.results import Results
from kurt2rt.experiments.study.table import Table
from kurt2rt.experiments.tuning.settings import TuningSettings


@dataclass(frozen=True, slots=True)
class Tuning:
    """Search of a rival's settings in one task, in a folder of its own."""

    rival: str
    plan: SearchPlan
    trials: int

    @property
    def robot_time_s(self) -> float:
        """Robot time of all trials if none is pruned, in s."""
        return trials_time_s(self.plan, self.trials)

    def run(self, executor: Executor, on_progress: Callable[[PoolProgress], None]) -> TunedRival:
        """Run the trials that are missing, and return the settings of the best one; the earlier of equal ones.

        Raises StudyError if the folder holds results of other settings, or another run writes there, and any error
        of a job.
        """
        with self.plan.jobs.parts["results"].held():
            journal = TrialJournal(self.plan)
            run_trials(self.plan, journal, self.trials, executor, on_progress)
            ended = finished(journal.trials[: self.trials])
        best = max(ended, key=lambda trial: (_score(trial), -trial.number))
        return TunedRival(
            task=self.plan.search.task,
            rival=self.rival,
            values=dict(best.params),
            trial=best.number,
            score=_score(best),
            first_score=_score(ended[0]),
        )


def plan_tuning(
    settings: TuningSettings, task: str, rival: str, parts: JobParts, trials: int, changes: Mapping[str, str]
) -> Tuning:
    """Return the tuning of a rival in a task; its folder lies within that of `parts`.

    `trials`: number of them. `changes`: values by dotted key of the task's file, of all trials.
    Raises SettingsError, NoLearnerError, BatchRefusedError.
    """
    own = JobParts(
        factory=parts["factory"], robot=parts["robot"], results=Results(parts["results"].folder / task / rival)
    )
    return Tuning(rival, make_plan(settings.search(task, rival, trials), own, changes=changes), trials)


def tuning_table(settings: TuningSettings, trials: int, found: Sequence[TunedRival]) -> Table:
    """Return a table with the settings of each rival's best trial. `trials`: number of them."""
    keys = [GATE, *(each.key for each in (*settings.space, *settings.rla_space))]
    return Table(
        f"Best of {trials} trials of each rival, taught by {settings.teacher}",
        ("task", "rival", "trial", "score", "score of the first", *keys),
        tuple(
            (
                *(each.task, each.rival, str(each.trial), f"{each.score:.3f}", f"{each.first_score:.3f}"),
                *("" if key not in each.values else f"{each.values[key]:g}" for key in keys),
            )
            for each in found
        ),
        words=2,
        note=f"Robots {spans(settings.seeds.seeds)}. Score: share of exams passed, and a little more for little "
        "effort. The first trial has the task's own numbers, and the default gate.",
    )


def _score(trial: FrozenTrial) -> float:
    assert trial.value is not None, "a finished trial has a score"
    return trial.value
