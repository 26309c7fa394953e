"""Points of the program at which something rare happens, in stories of faults only (`python -m tests.stories`).

What the kernel, a disk or another thread does once in years, such as a commit that is durable and fails nevertheless,
no simulation of the outside brings about. In the robot's program nothing happens here.
"""

from collections.abc import Callable
from typing import Literal

Point = Literal[
    "frames wait a cycle",
    "the send queue is full",
    "the bus is not back yet",
    "the inbox is full",
    "a request is malformed",
    "a picture is old",
    "an answer is forgotten",
    "the nearest rules are forgotten",
    "the disk is late",
    "the file is locked",
    "the file is opened again",
    "a durable commit fails",
    "statistics wait",
    "statistics are saved now",
    "acknowledgements wait",
    "a segment ends early",
]


def never(_: Point) -> bool:
    """Return False, as in the robot's program."""
    return False


happens: Callable[[Point], bool] = never
"""Returns whether something happens at a point now; stories replace it."""


def fail(point: Point, error: type[Exception], *told: object) -> None:
    """Raise an error with these arguments if something happens at a point now."""
    if happens(point):
        raise error(*told)
