"""Base of policies over sectors, for any robot with range sensors ahead and ahead to the left."""

from abc import ABC, abstractmethod
from typing import ClassVar, Generic, Protocol, TypeVar

from behaviors.policies.sectors import Metres, Sector
from hal.robot_settings import InfraredSettings


class FrontAndLeft(Protocol):
    """Settings that every policy over sectors has: two sectors, and the distance ahead at which it turns."""

    front: Sector
    left: Sector
    front_m: Metres
    """Distance in front below which the robot turns on the spot."""


SettingsT = TypeVar("SettingsT", bound=FrontAndLeft)


class SectorPolicy(ABC, Generic[SettingsT]):
    """Policy (behaviors.policies.policy.ReferencePolicy) that first looks ahead, then at the left sector."""

    blocked: ClassVar[str]
    """Action at an obstacle ahead."""

    def __init__(self, settings: SettingsT, infrared: InfraredSettings) -> None:
        """Find the sensors of both sectors. Raises config.settings.SettingsError for a sector without a sensor."""
        self._settings = settings
        self._front_m, self._left_m = settings.front.nearest(infrared), settings.left.nearest(infrared)

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002 - it knows only one
        """Return the name of the action for the counts of all sensors; `behaviour` is not used."""
        if self._front_m(infrared_counts) < self._settings.front_m:
            return self.blocked
        return self._way_on(self._left_m(infrared_counts), infrared_counts)

    @abstractmethod
    def _way_on(self, left_m: float, infrared_counts: tuple[int, ...]) -> str:
        """Return the action where the way ahead is free; `left_m`: distance in the left sector in m."""
