"""Named situations: goals that teachers gave names to."""

from collections.abc import Mapping

from kurt2rt.core.rla.condition import Condition
from kurt2rt.core.rla.events import SituationNamed


class NamedSituations:
    """Situations by level and name; the newest one of a name counts until its lesson is undone."""

    def __init__(self) -> None:
        self._stacks: dict[tuple[str, str], list[Condition]] = {}

    def add(self, named: SituationNamed) -> None:
        """Give a name to a situation of a level, in addition to earlier situations of this name."""
        self._stacks.setdefault((named.level, named.name), []).append(named.situation)

    def remove(self, named: SituationNamed) -> None:
        """Undo the newest lesson of a name; the situation of the lesson before counts again. Raises KeyError."""
        stack = self._stacks[named.level, named.name]
        stack.pop()
        if not stack:
            del self._stacks[named.level, named.name]

    def for_level(self, level: str) -> Mapping[str, Condition]:
        """Return the newest situation of each name of a level, by name."""
        return {name: stack[-1] for (of_level, name), stack in self._stacks.items() if of_level == level}
