"""Jobs of the doubt study: one robot in one world, which tells its doubt, stands, or turns away."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import anyio

from hal.robot_settings import RobotSettings
from hal.simulation import SimulationFactory
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.doubt.drive import DoubtSetup, drive
from kurt2rt.experiments.doubt.measures import DriveLog, judge_score, threshold_for
from kurt2rt.experiments.study.intervals import rate_of
from kurt2rt.experiments.study.pool import Progress
from kurt2rt.experiments.study.table import Table
from kurt2rt.knowledge.journal.loading import read_lessons

TICKS_PER_MINUTE = 6000


@dataclass(frozen=True, slots=True)
class DoubtJob:
    """Job of one taught robot in one world."""

    factory: SimulationFactory
    settings: RobotSettings
    task: TaskSettings
    knowledge: Path
    setup: DoubtSetup

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"{self.task.name}, seed {self.setup.seed}, world {self.setup.world}"

    @property
    def robot_time_s(self) -> float:
        """Time of the drive in s."""
        return self.setup.duration_s

    def run(self, tell: Progress) -> DriveLog:
        """Drive in the job's world and return the log; `tell` gets the simulated seconds.

        Raises KnowledgeError if the knowledge file cannot be read, SettingsError if task and world do not fit.
        """
        events = read_lessons(self.knowledge, self.settings, self.task)
        return anyio.run(drive, self.factory, self.settings, self.task, events, self.setup, tell)


def score_table(logs: Sequence[DriveLog], threshold: float) -> Table:
    """Return the quality of doubt at its threshold, and of distance / R with no more questions, of drives on end.

    `threshold`: score of doubt, dimensionless.
    """
    doubt, distance = [log.doubt for log in logs], [log.distance for log in logs]
    minutes = sum(float(log.driving.sum()) for log in logs) / TICKS_PER_MINUTE
    collisions, seen = sum(len(log.collisions) for log in logs), sum(sum(log.seen) for log in logs)
    found = judge_score(logs, doubt, threshold)
    control = judge_score(logs, distance, threshold_for(logs, distance, found.questions))
    rows = tuple(
        (
            name,
            f"{each.auc:.2f}",
            f"{each.caught} of {collisions}",
            f"{each.caught_seen} of {seen}",
            f"{2 * each.questions / max(minutes, 1e-9):.2f}",
            f"{2 * each.false_questions / max(minutes, 1e-9):.2f}",
        )
        for name, each in (("doubt", found), ("distance / R", control))
    )
    return Table(
        title=f"Doubt that is only told, {len(logs)} drives, {minutes:.0f} minutes",
        columns=("score", "AUC", "collisions caught", "with things seen", "questions in 2 min", "of them false"),
        rows=rows,
        note="Wrong: the policy turns away and the robot does not, for 0.3 s; or a collision follows within 2 s. "
        "Seen: a sensor saw it before, where the robot touches it; a thin thing may stand between all beams.",
    )


def _in_100_minutes(logs: Sequence[DriveLog]) -> str:
    """Return the collisions in 100 minutes with their 95 % interval, over the drives."""
    rate = rate_of([len(log.collisions) for log in logs], [len(log.doubt) / TICKS_PER_MINUTE / 100 for log in logs])
    return f"{rate.value:.1f} ({rate.low:.1f} to {rate.high:.1f})"


def collision_table(logs_by_response: Mapping[str, Sequence[DriveLog]], set_down_after_s: float) -> Table:
    """Return the collisions of drives by the robot's response to its doubt; all have as many drives.

    `set_down_after_s`: time after which a robot that asks was set down at another start; 0: it was not.
    """
    rows, drives = [], 0
    for name, logs in logs_by_response.items():
        drives = len(logs)
        minutes = sum(len(log.doubt) for log in logs) / TICKS_PER_MINUTE
        driven = sum(float(log.driving.sum()) for log in logs) / TICKS_PER_MINUTE
        count, seen = sum(len(log.collisions) for log in logs), sum(sum(log.seen) for log in logs)
        rows.append(
            (
                name,
                str(count),
                str(seen),
                _in_100_minutes(logs),
                f"{100 * count / max(driven, 1e-9):.1f}",
                f"{100 * driven / max(minutes, 1e-9):.0f} %",
                f"{sum(log.travelled_m for log in logs) / max(minutes, 1e-9):.1f}",
            )
        )
    return Table(
        title=f"Collisions without a teacher, {drives} drives each",
        columns=(
            "doubt",
            "collisions",
            "with things seen",
            "in 100 min (95 % interval)",
            "in 100 driven min",
            "time driven",
            "m in a minute",
        ),
        rows=tuple(rows),
        note=f"A question that is not answered for {set_down_after_s:g} s sets the robot down at another start."
        if set_down_after_s
        else "A robot that asks stands for as long as its question lasts.",
    )
