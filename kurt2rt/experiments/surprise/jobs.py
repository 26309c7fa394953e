"""Jobs of the surprise study: a robot learns what to expect, then drives with each difference."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import anyio

from hal.robot_settings import RobotSettings
from hal.simulation import SimulationFactory
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.study.pool import Progress
from kurt2rt.experiments.study.table import Table
from kurt2rt.experiments.surprise.drive import Difference, SurpriseCounts, SurpriseSetup, drive
from kurt2rt.knowledge.journal.loading import read_lessons

LEARNS_S = 900.0
"""Time to learn the expectations."""
DIFFERENT_S = 300.0
"""Time of the drive with each difference."""


@dataclass(frozen=True, slots=True)
class SurpriseJob:
    """Job of one taught robot."""

    factory: SimulationFactory
    settings: RobotSettings
    task: TaskSettings
    knowledge: Path
    seed: int
    learns_s: float = LEARNS_S
    different_s: float = DIFFERENT_S

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"{self.task.name}, seed {self.seed}"

    @property
    def robot_time_s(self) -> float:
        """Time of all drives in s."""
        return self.learns_s + 4 * self.different_s

    def run(self, tell: Progress) -> tuple[SurpriseCounts, ...]:
        """Run all drives of the robot and return the counters of each; `tell` gets the simulated seconds.

        Raises KnowledgeError, SettingsError.
        """
        return anyio.run(self._drives, tell)

    async def _drives(self, tell: Progress) -> tuple[SurpriseCounts, ...]:
        events = read_lessons(self.knowledge, self.settings, self.task)
        before_s = 0.0

        async def drives(
            saved: Statistics, difference: Difference, world: str, purpose: str, duration_s: float
        ) -> tuple[SurpriseCounts, Statistics]:
            nonlocal before_s
            result = await drive(
                self.factory,
                self.settings,
                self.task,
                events,
                saved,
                SurpriseSetup(world, difference, self.seed, duration_s, purpose),
                lambda done_s: tell(before_s + done_s),
            )
            before_s += duration_s
            return result

        known = self.task.teaching.world
        _, learned = await drives(Statistics(), "nothing", known, "getting to know", self.learns_s)
        cases: tuple[tuple[Difference, str], ...] = (
            ("nothing", known),
            ("stuck sensor", known),
            ("set down elsewhere", known),
            ("another world", f"streets-{self.seed}"),
        )
        return tuple(
            [(await drives(learned, difference, world, "surprise", self.different_s))[0] for difference, world in cases]
        )


def surprise_table(results: Sequence[Sequence[SurpriseCounts]]) -> Table:
    """Return the table of all robots, a row for each difference; `results`: an equal sequence for each robot."""
    rows = []
    for drives in zip(*results, strict=True):
        ends = sum(each.ends for each in drives)
        shares = [each.surprising / max(each.ends, 1) for each in drives]
        firsts = sum(each.first_ends for each in drives)
        rows.append(
            (
                drives[0].difference,
                str(ends),
                _percent(sum(each.surprising for each in drives), ends),
                f"{100 * min(shares):.1f} to {100 * max(shares):.1f} %",
                _percent(sum(each.new_follow_ups for each in drives), ends),
                _percent(sum(each.surprising_first_ends for each in drives), firsts) if firsts else "",
                f"{100 * sum(each.share_unknown for each in drives) / len(drives):.1f} %",
            )
        )
    return Table(
        title=f"Surprise, {len(results)} robots",
        columns=(
            *("different", "ends of RLAs", "surprising", "of single robots"),
            *("new follow-up", "first after set down", "time not known"),
        ),
        rows=tuple(rows),
    )


def _percent(part: int, whole: int) -> str:
    return f"{100 * part / max(whole, 1):.1f} %"
