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
from kurt2rt.experiments.study.table import Table, of_text, table_of, to_text
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
    return table_of(
        f"Doubt that is only told, {len(logs)} drives, {minutes:.0f} minutes",
        (("doubt", found), ("distance / R", control)),
        ("score", lambda row: row[0]),
        ("AUC", lambda row: f"{row[1].auc:.2f}"),
        ("collisions caught", lambda row: of_text(row[1].caught, collisions)),
        ("with things seen", lambda row: of_text(row[1].caught_seen, seen)),
        ("questions in 2 min", lambda row: f"{2 * row[1].questions / max(minutes, 1e-9):.2f}"),
        ("of them false", lambda row: f"{2 * row[1].false_questions / max(minutes, 1e-9):.2f}"),
        note="Wrong: the policy turns away and the robot does not, for 0.3 s; or a collision follows within 2 s. "
        "Seen: a sensor saw it before, where the robot touches it; a thin thing may stand between all beams.",
    )


def _in_100_minutes(logs: Sequence[DriveLog]) -> str:
    """Return the collisions in 100 minutes with their 95 % interval, over the drives."""
    rate = rate_of([len(log.collisions) for log in logs], [len(log.doubt) / TICKS_PER_MINUTE / 100 for log in logs])
    return f"{rate.value:.1f} ({to_text(rate[1:], '.1f')})"


def collision_table(logs_by_response: Mapping[str, Sequence[DriveLog]], set_down_after_s: float) -> Table:
    """Return the collisions of drives by the robot's response to its doubt; all have as many drives.

    `set_down_after_s`: time after which a robot that asks was set down at another start; 0: it was not.
    """

    def minutes(logs: Sequence[DriveLog]) -> float:
        return max(sum(len(log.doubt) for log in logs) / TICKS_PER_MINUTE, 1e-9)

    def driven(logs: Sequence[DriveLog]) -> float:
        return sum(float(log.driving.sum()) for log in logs) / TICKS_PER_MINUTE

    def collisions(logs: Sequence[DriveLog]) -> int:
        return sum(len(log.collisions) for log in logs)

    return table_of(
        f"Collisions without a teacher, {max(map(len, logs_by_response.values()), default=0)} drives each",
        logs_by_response.items(),
        ("doubt", lambda row: row[0]),
        ("collisions", lambda row: collisions(row[1])),
        ("with things seen", lambda row: sum(sum(log.seen) for log in row[1])),
        ("in 100 min (95 % interval)", lambda row: _in_100_minutes(row[1])),
        ("in 100 driven min", lambda row: f"{100 * collisions(row[1]) / max(driven(row[1]), 1e-9):.1f}"),
        ("time driven", lambda row: f"{100 * driven(row[1]) / minutes(row[1]):.0f} %"),
        ("m in a minute", lambda row: f"{sum(log.travelled_m for log in row[1]) / minutes(row[1]):.1f}"),
        note=f"A question that is not answered for {set_down_after_s:g} s sets the robot down at another start."
        if set_down_after_s
        else "A robot that asks stands for as long as its question lasts.",
    )
