"""Loops that drive lessons and exams: over the CAN bus, or in a batch with witnesses on the CAN bus."""

import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import TypeVar

from hal.errors import UserError

_DriveT = TypeVar("_DriveT")

WITNESS_SHARE = 0.01
LEAST_WITNESSES = 3


class DriveLoop(StrEnum):
    """Loop that drives exams or lessons."""

    BUS = "bus"
    """Loop over the simulated CAN bus."""
    BATCH = "batch"
    """Compiled loop; drives that it does not finish are driven on the CAN bus."""


class BatchDiffersError(UserError):
    """A drive had one result in the batch and another one on the CAN bus: no result of the study can be trusted."""


@dataclass(frozen=True, slots=True)
class DriveLoops:
    """Loops of one robot's lesson and exams."""

    lesson: DriveLoop = DriveLoop.BUS
    exams: DriveLoop = DriveLoop.BUS

    @property
    def in_batch(self) -> bool:
        """Return whether a batch drives any of them."""
        return DriveLoop.BATCH in (self.lesson, self.exams)


ON_BUS = DriveLoops()


def choose_witnesses(drives: Sequence[_DriveT], of: str, *, least: int = LEAST_WITNESSES) -> list[_DriveT]:
    """Return 1 % of the drives of a study, by chance.

    The order of the drives decides nothing, and most drives that are chosen stay so in a larger study.

    Args:
        drives: each with a text of its own.
        of: seed of the chance.
        least: number of witnesses of a small study; all of its drives if there are fewer.
    """
    wanted = min(len(drives), max(least, math.ceil(WITNESS_SHARE * len(drives))))
    return sorted(drives, key=lambda drive: hashlib.sha256(f"witness of {of}: {drive}".encode()).digest())[:wanted]
