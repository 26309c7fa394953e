"""Expected follow-up RLAs of the basic level as symbols."""

from collections import Counter
from collections.abc import Mapping
from typing import Annotated

from pydantic import Field

from kurt2rt.core.decision.decision import Decision
from kurt2rt.core.decision.junction_event import JunctionEvent
from kurt2rt.core.mid.junction_detector import JunctionDetector
from kurt2rt.core.mid.symbols.source import NONE, SymbolSettings, SymbolSource, Transitions


class ExpectationsSettings(SymbolSettings):
    """Settings of follow-up RLAs as symbols; the symbols are RLA ids."""

    least_share: Annotated[float, Field(ge=0, le=1)]
    """Least share of a follow-up among all transitions from an RLA."""

    @property
    def names(self) -> tuple[str, ...]:
        """Empty: RLAs have numbers."""
        return ()

    def build(self, transitions: Transitions) -> SymbolSource:
        """Return a source that starts with these counts: (RLA id, follow-up id) -> count."""
        return ExpectationSymbols(self.least_share, transitions)


class ExpectationSymbols:
    """Source of each most frequent follow-up RLA, at a change; counts continue while the robot drives."""

    def __init__(self, least_share: float, transitions: Mapping[tuple[int, int], int]) -> None:
        self._least_share = least_share
        self._follow_ups: dict[int, Counter[int]] = {}
        for (before, after), count in transitions.items():
            self._follow_ups.setdefault(before, Counter())[after] += count
        self.restart()

    def restart(self) -> None:
        """Forget the last RLA and symbol."""
        self._driver: int | None = None
        self._last = NONE

    def perceive(self, before: Decision, detector: JunctionDetector, passed: JunctionEvent | None) -> int:  # noqa: ARG002
        """Return the id of an expected RLA that took over in the last tick; NONE without one.

        `before`: decision of the last tick. The other arguments are not used.
        """
        driver, self._driver = self._driver, before.rla_id
        if self._driver is None or driver is None or self._driver == driver:
            return NONE
        follow_ups = self._follow_ups.setdefault(driver, Counter())
        follow_ups[self._driver] += 1
        count = follow_ups[self._driver]
        expected = count == max(follow_ups.values()) and count >= self._least_share * follow_ups.total()
        if not expected or self._driver == self._last:
            return NONE
        self._last = self._driver
        return self._last
