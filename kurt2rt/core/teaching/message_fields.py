"""Types of the fields in a teacher's messages that are about the robot."""

from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from kurt2rt.core.decision.goal import Goal, NamedGoal, PartialGoal, RlaGoal
from kurt2rt.core.lesson_speed import SLOWEST
from kurt2rt.core.message_fields import Float, Name, Number, OneOf, UpTo, worded
from kurt2rt.core.rla.rla import BASIC, MID, Phase

HIGHEST_SPEED_M_S = 2.0
LONGEST_BEHAVIOUR_TICKS = 60_000
"""Ten minutes at 100 Hz."""
MOST_GOAL_FEATURES = 16
MOST_SEGMENTS = 12
"""Largest number of segments of a drive by hand that are published; older ones stay untaught."""
SLOWEST_PERCENT = round(100 * SLOWEST)
"""Least speed of a lesson."""

Speed = Annotated[float, Float(HIGHEST_SPEED_M_S, "m/s")]
Level = Annotated[str, OneOf((BASIC, MID))]
PhaseNumber = Annotated[Phase, OneOf(tuple(each.value for each in Phase), Phase)]


class Feature(NamedTuple):
    """Feature of a goal, with the wanted value."""

    name: Name
    value: Annotated[float, Float(1e6)]


class _GoalLike(NamedTuple):
    features: Annotated[tuple[Feature, ...], UpTo(MOST_GOAL_FEATURES)]
    tolerance: Annotated[float, Float(1e6)]


@dataclass(frozen=True, slots=True)
class GoalField:
    """Check of a goal: the name of a situation, the number of an RLA, or features with a tolerance."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Return the schema."""

        def goal(value: Any) -> Goal:
            match value:
                case str():
                    return NamedGoal(value)
                case int():
                    return RlaGoal(value)
            return PartialGoal(tuple(map(tuple, value.features)), value.tolerance)

        forms = handler.generate_schema(Name | Number | _GoalLike)
        schema = core_schema.no_info_after_validator_function(
            goal, core_schema.no_info_before_validator_function(plain, forms)
        )
        text = "has to be a name, the number of an RLA, or a list of features and a tolerance"
        return worded(schema, text)


def plain(value: Any) -> Any:
    """Return a goal as it is sent: its one field, or the list of its fields; other values as they are."""
    match value:
        case NamedGoal(name=name):
            return name
        case RlaGoal(rla_id=rla_id):
            return rla_id
        case PartialGoal(features=features, tolerance=tolerance):
            return [features, tolerance]
    return value
