"""Texts of the status of a goal."""

from collections.abc import Mapping

from kurt2rt.core.decision.plan_step import GoalStatus

_TEXTS: Mapping[str, str] = {
    GoalStatus.ARRIVED: "arrived: {goal}",
    GoalStatus.PLANNING: "planning the way to {goal}",
    GoalStatus.NO_WAY: "no way from here to {goal}: nothing taught leads there",
    GoalStatus.LOST: "lost on the way to {goal}: this place is not known; answer here, or set it down",
    GoalStatus.UNDER_WAY: "on the way to {goal}: the plan begins behind the next junction",
}


def goal_text(status: str, goal: str) -> str:
    """Return a line for a teacher: a goal's text with its status.

    `status`: value of GoalStatus. `goal`: text of the goal.
    """
    return _TEXTS[status].format(goal=goal)
