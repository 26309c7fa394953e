"""Engines that drive lessons and exams: the simulated CAN bus, or a compiled batch with witnesses on the CAN bus."""

import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import TypeVar

from config.errors import UserError

_DriveT = TypeVar("_DriveT")

WITNESS_SHARE = 0.01
LEAST_WITNESSES = 3
MOST_WITNESSES = 20
"""More would take longer on the bus than ten thousand drives in the batch."""


class Engine(StrEnum):
    """Engine that drives a lesson or an exam in simulated time."""

    CAN = "can"
    """Simulated CAN bus, robot by robot."""
    COMPILED = "compiled"
    """Compiled batch of robots; drives that it does not finish are driven on the CAN bus."""


class BatchDiffersError(UserError):
    """A drive had one result in the batch and another one on the CAN bus: no result of the study can be trusted."""


@dataclass(frozen=True, slots=True)
class Engines:
    """Engines that a job of a study uses: one for its lesson, one for its exams."""

    lesson: Engine = Engine.CAN
    exams: Engine = Engine.CAN

    @property
    def in_batch(self) -> bool:
        """Return whether a batch drives any of them."""
        return Engine.COMPILED in (self.lesson, self.exams)


ON_BUS = Engines()


def choose_witnesses(drives: Sequence[_DriveT], of: str, *, least: int = LEAST_WITNESSES) -> list[_DriveT]:
    """Return 1 % of the drives of a study, at most 20, by chance.

    The order of the drives decides nothing, and most drives that are chosen stay so in a larger study.

    Args:
        drives: each with a text of its own.
        of: seed of the chance.
        least: number of witnesses of a small study; all of its drives if there are fewer.
    """
    wanted = min(max(least, math.ceil(WITNESS_SHARE * len(drives))), MOST_WITNESSES)
    return sorted(drives, key=lambda drive: hashlib.sha256(f"witness of {of}: {drive}".encode()).digest())[:wanted]
