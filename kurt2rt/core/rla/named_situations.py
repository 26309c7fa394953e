"""Situations that teachers gave names to."""

from collections.abc import Mapping

from kurt2rt.core.rla.condition import Condition
from kurt2rt.core.rla.rla import SituationNamed


class NamedSituations:
    """By level and name; a name that is given again means the newer situation, until that is undone."""

    def __init__(self) -> None:
        self._given: dict[tuple[str, str], list[Condition]] = {}

    def add(self, named: SituationNamed) -> None:
        """A name is given."""
        self._given.setdefault((named.level, named.name), []).append(named.situation)

    def remove(self, named: SituationNamed) -> None:
        """The newest of those that were given that name has it no more."""
        given = self._given[named.level, named.name]
        given.pop()
        if not given:
            del self._given[named.level, named.name]

    def for_level(self, level: str) -> Mapping[str, Condition]:
        """What each name of a level means now."""
        return {name: given[-1] for (of_level, name), given in self._given.items() if of_level == level}
