"""Exams of a knowledge file, one for each world, over the CAN bus."""

from collections.abc import Sequence
from pathlib import Path

import anyio

from hal.robot_settings import RobotSettings
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.compatibility import with_own_route
from kurt2rt.experiments.lockstep.curriculum import Report, run_exams
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.faulty_sensor import parse_break
from kurt2rt.experiments.study.jobs import require_places
from kurt2rt.knowledge.journal.loading import read_lessons
from simbridge.contracts.robot_kind import simulations_of


def examine_file(
    knowledge: Path,
    robot: RobotSettings,
    task: TaskSettings,
    seed: int,
    report: Report,
    *,
    worlds: Sequence[str] = (),
    broken: str | None = None,
) -> tuple[DriveRow, ...]:
    """Examine the robot of a file in each world, next to its teacher's policy, and return the drives in order.

    Args:
        knowledge: file with its lessons.
        robot: settings of the robot.
        task: that was taught; a route that names no seed is that of this robot.
        seed: of the robot, its noise and its start.
        report: progress callback.
        worlds: empty: those of the task.
        broken: sensor that breaks and the way in which, such as s15=low; None: all work.

    Raises:
        KnowledgeError: the file cannot be read.
        config.settings.SettingsError: task and worlds do not fit.
        LessonLostError: the robot refused a command.
    """
    task, stage = with_own_route(task, seed), simulations_of(robot)
    worlds = tuple(worlds) or task.exam.worlds
    require_places(stage, task, worlds)
    events = read_lessons(knowledge, robot, task)
    sensor = None if broken is None else parse_break(broken, robot.infrared)

    async def run() -> tuple[DriveRow, ...]:
        return await run_exams(stage, robot, task, events, worlds, seed=seed, report=report, broken=sensor)

    return anyio.run(run)
