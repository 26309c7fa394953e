"""Explanation of the newest decision of a running robot for `kurt2rt why --live`."""

from collections.abc import Callable
from typing import NamedTuple

import anyio

from config.settings import SettingsError
from hal.robot_settings import RobotSettings
from kurt2rt.channel.security.pairing import Device
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.task_settings import installed_task, load_task
from kurt2rt.runs.explain.counterfactual import SensorCounterfactual, sensor_counterfactuals
from kurt2rt.runs.explain.facts import DecisionFacts
from kurt2rt.teacher.client.answer import NoAnswerError, no_robot
from kurt2rt.teacher.client.observer_client import ANSWER_WITHIN_S, ObserverClient

_FIRST_TICK_S = 0.1


class LiveQuestion(NamedTuple):
    """Facts of a running robot's newest decision, with the readings that would have changed it."""

    facts: DecisionFacts
    counterfactuals: tuple[SensorCounterfactual, ...]
    """Counterfactuals among the reported RLAs; empty for a task that is unknown here."""
    robot: RobotSettings


def ask_why(
    device: Device, robot_of: Callable[[str], RobotSettings], *, patience_s: float = ANSWER_WITHIN_S
) -> LiveQuestion:
    """Ask a robot, as a client that does not teach, for the facts behind its newest decision.

    Args:
        device: paired device of this machine, with the address of the robot.
        robot_of: returns the settings of the robot that a task of this name is taught to.
        patience_s: time to wait for the answer, in s.

    Raises:
        NoAnswerError: no robot answers.
        CredentialsError: the pairing cannot be opened.
    """

    async def ask() -> DecisionFacts:
        async with ObserverClient(device.folder, device.host, device.port, patience_s=patience_s) as client:
            client.watching = False  # a question alone does not report the teacher as present
            while (facts := await client.why()) is None:  # noqa: ASYNC110 - no event announces the first tick
                await anyio.sleep(_FIRST_TICK_S)
            return facts

    try:
        facts = anyio.run(ask)
    except NoAnswerError as error:
        raise no_robot(device.host, device.port, device.name) from error
    robot = robot_of(facts.task)
    return LiveQuestion(facts, _counterfactuals_of(facts, robot), robot)


def _counterfactuals_of(facts: DecisionFacts, robot: RobotSettings) -> tuple[SensorCounterfactual, ...]:
    """Return the counterfactuals with another answering RLA.

    Unless all RLAs were reported, an unreported one may answer instead of a question.
    """
    try:
        definition = load_situation(load_task(installed_task(facts.task)).situation, robot.infrared.names)
    except SettingsError:  # the task is not installed on this machine
        return ()
    if definition.names != facts.basic.names or len(facts.infrared_counts) != len(robot.infrared.sensors):
        return ()
    told_of_all = facts.basic.count <= 1 + len(facts.basic.others)
    found = sensor_counterfactuals(facts, definition, robot.infrared)
    return found if told_of_all else tuple(each for each in found if each.rla is not None)
