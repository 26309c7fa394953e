"""DAgger: the policy drives more and more, and the teacher labels all that it meets."""

from kurt2rt.experiments.rivals.holds.cloning import Cloning
from kurt2rt.teacher.scripted.teacher_in_charge import Charge

DECAY = 0.7
"""p of beta_i = p^i; Ross et al. recommend this form. 0.7 was the value of the comparison that is planned."""


class Dagger(Cloning):
    """DAgger (Ross, Gordon and Bagnell, AISTATS 2011, algorithm 3.1).

    In iteration i, from 0, each action is the teacher's with the probability beta_i = 0.7^i, otherwise the learner's.
    Each situation gets the teacher's label, and each fit is to all labels so far.
    """

    charge = Charge.NAMES

    @property
    def beta(self) -> float:
        """Probability of the teacher's action in the present iteration, 0 to 1."""
        return DECAY**self.iteration

    def drives_by_teacher(self, chance: float) -> bool:
        """Return whether the teacher's action drives now; `chance`: drawn from 0 to 1."""
        return chance < self.beta
