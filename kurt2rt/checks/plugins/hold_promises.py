"""Promises of a learner with a teacher in charge, tried on made-up holds."""

import numpy as np

from kurt2rt.core.learner.conformance import broken_among, made_up
from kurt2rt.core.learner.learner import LearnerFactory, LearnerSetting, Why
from kurt2rt.experiments.rivals.holds.hold_learner import HoldLearner
from kurt2rt.teacher.scripted.teacher_in_charge import Charge

_PROBES = 20


def broken_of_hold_learner(make: LearnerFactory, setting: LearnerSetting) -> list[str]:
    """Return the promises of `HoldLearner` that a learner breaks, each in a sentence; none if it claims to be no such.

    Args:
        make: returns a new learner of the setting.
        setting: of a task, with at least two actions. Its seed makes the situations.
    """
    if not (hasattr(make, "charge") or (isinstance(make, type) and issubclass(make, HoldLearner))):
        return []
    check = _HoldCheck(make, setting)
    return broken_among(
        (
            ("a learner with `charge` is a subclass of HoldLearner", check.is_one),
            (f"`charge` is one of {', '.join(f'Charge.{each.name}' for each in Charge)}", check.has_charge),
            ("`act` returns one finite preference for each action", check.prefers_each),
            ("`asks` and `is_ready` return True or False", check.answers_in_words),
            ("with Charge.BY_ROBOT, `asks` and `is_ready` are its own", check.can_ask),
            ("it takes samples of its own drives, if `takes_own_samples` says so", check.takes_own_drives),
            ("lessons change no decision between two fits of a run", check.waits_for_fits),
        )
    )


class _HoldCheck:
    """Learner that was taught by holds."""

    def __init__(self, make: LearnerFactory, setting: LearnerSetting) -> None:
        self._make, self._setting = make, setting
        self._situations, self._actions, probes = made_up(setting)
        self._probes = probes[:_PROBES]

    def is_one(self) -> bool | str:
        return isinstance(made := self._make(self._setting), HoldLearner) or f"it is a {type(made).__name__}"

    def has_charge(self) -> bool | str:
        charge = getattr(self._make, "charge", None)
        return isinstance(charge, Charge) or f"it is {charge!r}"

    def prefers_each(self) -> bool:
        learner = self._taught()
        found = [np.asarray(learner.act(learner.point(each))) for each in self._probes]
        return all(each.shape == (len(self._setting.actions),) and np.isfinite(each).all() for each in found)

    def answers_in_words(self) -> bool:
        learner = self._taught()
        points = [learner.point(each) for each in self._probes]
        return all(
            isinstance(said, bool | np.bool_) for p in points for said in (learner.asks(p), learner.is_ready(p, 0))
        )

    def can_ask(self) -> bool:
        learner = self._new()
        kind = type(learner)
        return learner.charge is not Charge.BY_ROBOT or not (
            kind.asks is HoldLearner.asks or kind.is_ready is HoldLearner.is_ready
        )

    def takes_own_drives(self) -> bool:
        learner = self._taught()
        if learner.takes_own_samples:
            learner.on_takeover(self._situations[0])
            learner.on_trouble()
            for why in (Why.DROVE, Why.OVERRULED):
                learner.lesson(self._situations[0], self._actions[0], why)
            learner.refit()
            learner.decide(self._probes[0], taught=True)
        return True

    def waits_for_fits(self) -> bool:
        learner = self._new()
        learner.fits_at_intervals = True
        self._teach(learner)
        before = self._decisions(learner)
        for probe, decided in zip(self._probes, before, strict=True):
            learner.lesson(probe, next(each for each in self._setting.actions if each != decided), Why.HOLD)
        return self._decisions(learner) == before

    def _new(self) -> HoldLearner:
        learner = self._make(self._setting)
        if not isinstance(learner, HoldLearner):
            raise TypeError("is no subclass of HoldLearner")
        return learner

    def _taught(self) -> HoldLearner:
        learner = self._new()
        self._teach(learner)
        return learner

    def _teach(self, learner: HoldLearner) -> None:
        for situation, action in zip(self._situations, self._actions, strict=True):
            learner.lesson(situation, action, Why.HOLD)
        learner.refit()

    def _decisions(self, learner: HoldLearner) -> list[str | None]:
        return [learner.decide(probe, taught=False) for probe in self._probes]
