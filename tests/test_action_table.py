"""Table of the actions of all shipped robots in the documents, which people who write tasks and policies read."""

from pathlib import Path

from behaviors.repertoire_settings import KeepDistanceAction, MotorAction, RepertoireSettings, TurnByAngleAction
from hal.settings import load_settings
from hal.settings_files import find_config

DOCUMENT = Path(__file__).parents[1] / "docs" / "add-a-task.md"
REPERTOIRES = ("basic", "school/basic", "turtlebot/basic")


def cell(action: object) -> str:
    """Return what an action does, with speeds in m/s."""
    match action:
        case MotorAction(left_m_s=left, right_m_s=right):
            return f"{left:.3g}, {right:.3g}"
        case KeepDistanceAction(distance_m=distance, speed_m_s=speed, front_sensor=front, back_sensor=back):
            return f"{distance:g} m from what {front} and {back} see, at {speed:g}"
        case TurnByAngleAction(angle_deg=angle, speed_m_s=speed):
            return f"turns by {angle:g}°, at {speed:g}"
    raise ValueError(f"no words for the action {action}")


def rows() -> list[str]:
    """Return the rows of the table: one for each name, with a cell for each repertoire."""
    actions = [
        {
            action.name: cell(action)
            for action in load_settings(find_config("repertoires", name), RepertoireSettings).actions
        }
        for name in REPERTOIRES
    ]
    names = dict.fromkeys(name for each in actions for name in each)
    return [f"| `{name}` | " + " | ".join(each.get(name, "-") for each in actions) + " |" for name in names]


def test_table_of_actions_is_that_of_the_repertoires() -> None:
    head = f"| action | {' | '.join(f'`{name}`' for name in REPERTOIRES)} |"
    table = "\n".join([head, "| --- |" + " --- |" * len(REPERTOIRES), *rows()]) + "\n"
    assert table in DOCUMENT.read_text(encoding="utf-8"), f"the table has to be\n{table}"
