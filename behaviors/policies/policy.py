"""The contract of a reference policy."""

from abc import abstractmethod
from typing import ClassVar, Protocol

from hal.robot_settings import InfraredSettings
from hal.settings_by_kind import KindSettings


class ReferencePolicy(Protocol):
    """Names the right action for what the sensors show now.

    Memoryless, because a robot can only learn from what is in its situation: hidden state in the teacher's head is
    unlearnable.
    """

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:
        """Name of the action to take, of the repertoire. `infrared_counts`: as in SensorReadings.

        `behaviour`: the taught behaviour that is wanted, empty where the task has only one.
        """
        ...


class PolicySettings(KindSettings):
    """Base of the settings of every policy: a class named after its file in this folder, which is the kind."""

    behaviours: ClassVar[tuple[str, ...] | None] = None
    """The taught behaviours that it tells apart; None: it does the same whatever is wanted."""

    @abstractmethod
    def build(self, infrared: InfraredSettings) -> ReferencePolicy:
        """The policy, for a robot with these sensors."""
