"""Journal of the trials of a search, in Optuna's format: a line for each step, durable before the next one."""

import math
from collections.abc import Sequence
from pathlib import Path
from statistics import median

import optuna
from optuna.distributions import BaseDistribution, FloatDistribution
from optuna.storages import JournalStorage
from optuna.storages.journal import JournalFileBackend
from optuna.study import Study
from optuna.trial import FrozenTrial, Trial, TrialState, create_trial

from kurt2rt.experiments.search.plan import SearchPlan
from kurt2rt.experiments.search.settings import Dimension
from kurt2rt.experiments.search.space import Values, rounded
from kurt2rt.experiments.study.provenance import Provenance
from kurt2rt.experiments.study.results import StudyError

FILE = "journal.log"
_MADE_OF = "made_of"
_STARTUP_TRIALS = 10
"""Trials with random values, before a model of the earlier ones chooses."""
_PRUNES_AFTER_TRIALS = 4


class TrialJournal:
    """Trials of a search. The same journal, search and number of trials give the same next trial."""

    def __init__(self, plan: SearchPlan) -> None:
        """Open the journal in the folder of results, or begin it. The folder must be locked.

        Raises StudyError for a journal of other settings or another program, or a damaged one.
        """
        optuna.logging.set_verbosity(optuna.logging.WARNING)
        self._dimensions = {each.key: each for each in plan.search.space}
        self._seed = plan.search.sampler_seed
        self._shipped = plan.space.shipped
        path = plan.folder / FILE
        _drop_unfinished_line(path)
        Path(f"{path}.lock").unlink(missing_ok=True)  # left by a killed process; no other one writes here
        try:
            storage = JournalStorage(JournalFileBackend(str(path)))
            known = optuna.get_all_study_names(storage)
            if known:
                self._study = optuna.load_study(study_name=None, storage=storage)
            else:
                name = plan.search.name
                self._study = optuna.create_study(study_name=name, storage=storage, direction="maximize")
        except (ValueError, KeyError) as error:
            raise StudyError("is not a journal of trials", where=path, do="give a new folder with --out") from error
        self._require_same_make(plan.made_of, path)

    @property
    def trials(self) -> list[FrozenTrial]:
        """All trials in order."""
        return self._study.get_trials(deepcopy=False)

    def values(self, number: int) -> Values:
        """Return the values of a trial by key."""
        return self.trials[number].params

    def begin(self, number: int) -> None:
        """Begin the trial of the next number; the first one has the shipped values."""
        values = self._choose(number) if number else self._shipped
        chosen = {key: rounded(each, values[key]) if number else values[key] for key, each in self._dimensions.items()}
        distributions = {key: _distribution(each) for key, each in self._dimensions.items()}
        # One line of the journal, so that no trial is there with a part of its values.
        self._study.add_trial(create_trial(state=TrialState.RUNNING, params=chosen, distributions=distributions))

    def report(self, number: int, step: int, score: float) -> None:
        """Note the score of a trial's first `step + 1` robots, once; `score` is dimensionless."""
        trial = self.trials[number]
        if step not in trial.intermediate_values:
            Trial(self._study, trial._trial_id).report(score, step)

    def median_score(self, first: int) -> float:
        """Return the median score of the finished trials before number `first`; -inf if they are too few to prune by.

        The score is dimensionless.
        """
        scores = [trial.value for trial in finished(self.trials[:first]) if trial.value is not None]
        return median(scores) if len(scores) >= _PRUNES_AFTER_TRIALS else -math.inf

    def prune(self, number: int) -> None:
        """End a trial without a score."""
        self._study.tell(number, state=TrialState.PRUNED)

    def finish(self, number: int, score: float) -> None:
        """End a trial with the score of all its robots, dimensionless."""
        self._study.tell(number, score)

    def _choose(self, number: int) -> Values:
        """Return the values that a model of all trials so far chooses, by a random stream of the trial's own."""
        sampler = optuna.samplers.TPESampler(seed=self._seed * 100_000 + number, n_startup_trials=_STARTUP_TRIALS)
        study: Study = optuna.create_study(sampler=sampler, direction="maximize")
        study.add_trials(self.trials)
        return study.ask({key: _distribution(each) for key, each in self._dimensions.items()}).params

    def _require_same_make(self, made_of: Provenance, path: Path) -> None:
        known = self._study.user_attrs.get(_MADE_OF)
        if known is None:
            self._study.set_user_attr(_MADE_OF, made_of.model_dump())
            return
        differing = Provenance.model_validate(known).differences(made_of)
        if differing:
            raise StudyError(
                f"its trials were made with other settings or another program (what differs: {', '.join(differing)})",
                where=path,
                do="give a new folder with --out",
            )


def finished(trials: Sequence[FrozenTrial]) -> list[FrozenTrial]:
    """Return the trials that have a score."""
    return [trial for trial in trials if trial.state is TrialState.COMPLETE]


def _distribution(dimension: Dimension) -> BaseDistribution:
    return FloatDistribution(dimension.low, dimension.high, log=dimension.log)


def _drop_unfinished_line(path: Path) -> None:
    """Cut off a last line that a killed process left without its end."""
    if path.exists():
        content = path.read_bytes()
        whole = content[: content.rfind(b"\n") + 1]
        if whole != content:
            with path.open("r+b") as file:
                file.truncate(len(whole))
