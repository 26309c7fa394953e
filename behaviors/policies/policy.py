"""Contract of reference policies."""

from abc import abstractmethod
from typing import ClassVar, Protocol

from config.settings_by_kind import KindSettings
from hal.robot_settings import InfraredSettings


class ReferencePolicy(Protocol):
    """Rules that drive a task right, as an expert would: what scripted teachers answer, and what exams compare with.

    It has no memory, because a robot cannot learn from hidden state of the teacher. For example wall following: nearer
    than 15 cm to the wall, curve away.
    """

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:
        """Return the name of the action that is right in this tick.

        Args:
            infrared_counts: readings of all sensors in counts, in the order of the sensor table.
            behaviour: selected taught behaviour; empty if the task has only one.
        """
        ...


class PolicySettings(KindSettings):
    """Base of the settings of every policy; the module's name in this folder is the kind."""

    behaviours: ClassVar[tuple[str, ...] | None] = None
    """Taught behaviours that the policy distinguishes; None if it ignores the selection."""
    chooses_among: ClassVar[tuple[str, ...] | None] = None
    """Names of the actions that the policy chooses among; None if that is not known before it drives."""

    @property
    def required_actions(self) -> tuple[str, ...]:
        """Names of the actions that a repertoire needs with these settings, as far as they are known."""
        return self.chooses_among or ()

    @abstractmethod
    def build(self, infrared: InfraredSettings) -> ReferencePolicy:
        """Return the policy for a robot with these sensors."""
