"""Difference between the features that knowledge was taught with and those of this robot, by name."""

from collections.abc import Iterator, Mapping

from pydantic import ValidationError

from hal.robot_settings import RobotSettings, robot_of_json
from hal.settings import SettingsError
from kurt2rt.core.perception.definition import AVERAGED, SituationDefinition, load_situation
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.knowledge.exchange.attachment_files import extracted_settings
from kurt2rt.knowledge.exchange.attachments import ROBOT, TASK

_MOST = 6


def differing_features(settings: Mapping[str, bytes], robot: RobotSettings, task: TaskSettings) -> str:
    """Return the differences of the basic situation, there against here, in a few words; empty if there are none.

    Raises hal.settings.SettingsError if the situation of `task`, here, cannot be loaded.

    Args:
        settings: files there, as `kurt2rt.knowledge.exchange.attachments` makes them. Unreadable ones count as
            different.
        robot: here.
        task: here.
    """
    try:
        with extracted_settings(settings):
            there_robot = robot_of_json(settings[ROBOT], "the package's robot")
            there_task = TaskSettings.model_validate_json(settings[TASK])
            there = load_situation(there_task.situation, there_robot.infrared.names)
    except (KeyError, ValidationError, SettingsError, OSError) as error:
        return f"its settings cannot be used here ({' '.join(str(error).split())})"
    here = load_situation(task.situation, robot.infrared.names)
    found = list(_differences(there, here))
    if there_robot.infrared.names != robot.infrared.names:
        found.append("the order of the robot's sensors")
    more = f" and {len(found) - _MOST} more" if len(found) > _MOST else ""
    return ", ".join(found[:_MOST]) + more


def _differences(there: SituationDefinition, here: SituationDefinition) -> Iterator[str]:
    known, wanted = ({each.name: each for each in definition.features} for definition in (there, here))
    for name in known:
        if name not in wanted:
            yield f"{name} (only there)"
        elif known[name] != wanted[name]:
            yield f"{name} (made of other sensors)"
    yield from (f"{name} (only here)" for name in wanted if name not in known)
    if known.keys() == wanted.keys() and list(known) != list(wanted):
        yield "their order"
    if there.history_steps != here.history_steps:
        yield f"all{AVERAGED}: over {there.history_steps} steps there, {here.history_steps} here"
    if there.wheel_speed_counts_per_m_s != here.wheel_speed_counts_per_m_s:
        scales = there.wheel_speed_counts_per_m_s, here.wheel_speed_counts_per_m_s
        yield "wheel speeds: {} counts per m/s there, {} here".format(*scales)
    if there.name != here.name:
        yield f"the definition's name: {there.name} there, {here.name} here"
