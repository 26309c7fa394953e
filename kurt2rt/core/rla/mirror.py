"""Mirror of a robot's left and right: the mirror images of situations, actions and RLAs."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.rla.rla import Rla


@dataclass(frozen=True, slots=True, eq=False)
class Mirror:
    """Exchange of left and right in situations, actions and taught behaviours; twice applied, nothing is changed.

    With it an RLA answers in two places: at its condition with its action, and at the mirror image of its condition
    with the mirror image of its action. Both are one RLA, with one id and one history.
    """

    order: NDArray[np.intp]
    """Feature i of a mirrored situation is feature `order[i]` of the situation, (d,)."""
    names: Mapping[str, str]
    """Mirror image of each action and taught behaviour that has another one as its image, by name."""

    def name(self, name: str) -> str:
        """Return the mirror image of an action or behaviour; the name itself if it looks the same."""
        return self.names.get(name, name)

    def situation(self, vector: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the mirror image of a situation (d,)."""
        return vector[self.order]

    def rla(self, rla: Rla) -> Rla:
        """Return the mirror image of an RLA, which has the same id."""
        return replace(
            rla,
            condition=tuple(self.situation(np.array(rla.condition)).tolist()),
            action=self.name(rla.action),
            behaviour=self.name(rla.behaviour),
            mirrored=not rla.mirrored,
        )
