"""Choice of the loop that drives exams: the CAN bus, or a batch with witnesses on the CAN bus."""

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass, fields
from enum import StrEnum
from typing import TypeVar

from hal.errors import UserError
from kurt2rt.experiments.lockstep.exam import ExamResult

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
class ExamDriver:
    """Loop of the exams of one robot."""

    loop: DriveLoop = DriveLoop.BUS
    witnesses: frozenset[str] = frozenset()
    """Worlds whose exams in the batch are driven on the CAN bus too, and must have the same results there."""


ON_BUS = ExamDriver()


def choose_drivers(loop: DriveLoop, robots: int, worlds: Sequence[str]) -> list[ExamDriver]:
    """Return the driver of each robot's exams in `worlds`: 1 % of them, at least three, have a witness."""
    if loop is DriveLoop.BUS:
        return [ON_BUS] * robots
    exams = [(robot, world) for robot in range(robots) for world in worlds]
    chosen = choose_witnesses(exams, f"{robots} robots")
    return [ExamDriver(loop, frozenset(world for other, world in chosen if other == robot)) for robot in range(robots)]


def choose_witnesses(drives: Sequence[_DriveT], of: str) -> list[_DriveT]:
    """Return 1 % of the drives of a study, at least three, by chance; `of`: seed of the chance."""
    wanted = min(len(drives), max(LEAST_WITNESSES, math.ceil(WITNESS_SHARE * len(drives))))
    return random.Random(f"witnesses of {of}").sample(drives, wanted)


def require_equal(batch: ExamResult, bus: ExamResult) -> None:
    """Check that an exam in the batch had the result of the CAN bus. Raises BatchDiffersError."""
    differing = [each.name for each in fields(ExamResult) if getattr(batch, each.name) != getattr(bus, each.name)]
    if differing:
        raise BatchDiffersError(
            f"the batch and the CAN bus differ in {', '.join(differing)}; all results of the batch are refused",
            where=f"exam in world {bus.world}, seed {bus.seed}",
            do="report it, and give --exams bus",
        )
