"""Score of settings: exams passed first, then few presses, collisions in lessons, or RLAs."""

from collections.abc import Sequence
from statistics import fmean
from typing import NamedTuple

from kurt2rt.experiments.search.settings import Objective
from kurt2rt.experiments.study.jobs import ExaminedOutcome

PRESSES_OF_A_COLLISION = 10
"""Presses that a collision in a lesson counts as: it may hurt someone, and a press takes a second.

With presses alone a search found settings of fleeing that ask 40 times less, and touch something 8 times as often.
"""


class RobotScore(NamedTuple):
    """Exams and effort of one robot."""

    passed: int
    exams: int
    """All exams, also those without a verdict: a search must not win by exams that are not judged."""
    presses: int
    collisions: int
    """Collisions while it was taught."""
    rlas: int

    @property
    def passed_share(self) -> float:
        """Exams passed as a fraction of all, 0 to 1."""
        return self.passed / self.exams


def robot_score(result: ExaminedOutcome) -> RobotScore:
    """Return the score of one robot's lesson and exams."""
    passed = sum(drive.passed for drive in result.drives)
    lesson = result.lesson
    return RobotScore(passed, len(result.drives), lesson.presses, lesson.collisions, lesson.rlas)


def effort(robot: RobotScore, objective: Objective) -> int:
    """Return the number that is to be small: presses, presses and collisions, or RLAs."""
    match objective:
        case "passed_then_presses":
            return robot.presses
        case "passed_then_presses_and_collisions":
            return robot.presses + PRESSES_OF_A_COLLISION * robot.collisions
        case "passed_then_rlas":
            return robot.rlas


def score_of(robots: Sequence[RobotScore], objective: Objective) -> float:
    """Return a score, dimensionless: the share of exams passed, and less than half an exam more for little effort.

    One more exam passed outweighs any effort.
    """
    exams = sum(robot.exams for robot in robots)
    passed = sum(robot.passed for robot in robots)
    return (passed + 0.5 / (1.0 + fmean(effort(robot, objective) for robot in robots))) / exams


def highest_score(robots: Sequence[RobotScore], exams: int) -> float:
    """Return a bound that no score reaches, dimensionless: as if all other exams were passed without effort.

    `exams`: number of exams of all robots, also of those that come after `robots`.
    """
    failed = sum(robot.exams - robot.passed for robot in robots)
    return (exams - failed + 0.5) / exams
