"""Images of RLAs: the other places in which one answers, in a mirror and at another width."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.rla.rla import Rla

Change = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""Function from a situation (d,) to another one (d,)."""


@dataclass(frozen=True, slots=True, eq=False)
class Image:
    """View in which each RLA answers, too: where its situation is seen in a mirror, or at another width.

    With it an RLA answers in two places: at its condition with its action, and at the image of its condition with the
    image of its action. Both are one RLA, with one id and one history.
    """

    name: str
    """Follows the id in the RLA's title: `mirrored`, or `x1.2` at 1.2 times the width."""
    of_taught: Change
    """Returns the image of a situation."""
    as_taught: Change
    """Returns the situation whose image is given; at another width nearly."""
    estimated: bool
    """True at another width, where the law of the sensors is all that is known; a mirror is exact."""
    names: Mapping[str, str]
    """Image of each action and taught behaviour that has another one as its image; twice applied it is itself."""

    def name_of(self, name: str) -> str:
        """Return the image of an action or behaviour; the name itself if it looks the same."""
        return self.names.get(name, name)

    def rla(self, rla: Rla) -> Rla:
        """Return the image of an RLA as it was taught, which has the same id."""
        return replace(
            rla,
            condition=tuple(self.of_taught(np.array(rla.condition)).tolist()),
            action=self.name_of(rla.action),
            behaviour=self.name_of(rla.behaviour),
            image=self.name,
        )

    def then(self, other: "Image") -> "Image":
        """Return the image of this image in another one."""
        return Image(
            f"{self.name} {other.name}",
            lambda situation: other.of_taught(self.of_taught(situation)),
            lambda situation: self.as_taught(other.as_taught(situation)),
            self.estimated or other.estimated,
            {**other.names, **self.names},
        )
