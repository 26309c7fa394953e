"""Schema of `config/repertoires/*.yaml`: the actions a teacher may choose from."""

from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from hal.settings import Settings

Speed = Annotated[float, Field(ge=-1.0, le=1.0)]
PositiveSpeed = Annotated[float, Field(gt=0, le=1.0)]
RESERVED = "ask"
"""Stands in place of an RLA's action that was withdrawn (kurt2rt.rla.rla.ASK)."""


def _require_free(name: str) -> str:
    if name == RESERVED:
        raise ValueError(
            f"{RESERVED} stands for an action that was withdrawn, where the robot asks; give the action another name"
        )
    return name


ActionName = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,39}$"), AfterValidator(_require_free)]


class MotorAction(Settings):
    """Direct motor values."""

    kind: Literal["motor"]
    name: ActionName
    left_m_s: Speed
    right_m_s: Speed


class KeepDistanceAction(Settings):
    """Control loop along a wall."""

    kind: Literal["keep_distance"]
    name: ActionName
    front_sensor: str
    back_sensor: str
    distance_m: Annotated[float, Field(ge=0.1, le=0.6)]
    speed_m_s: PositiveSpeed
    gain_per_m: Annotated[float, Field(gt=0, le=50)]


class TurnByAngleAction(Settings):
    """Simple behaviour: turn on the spot by an angle, left positive."""

    kind: Literal["turn_by_angle"]
    name: ActionName
    angle_deg: Annotated[float, Field(ge=-360, le=360)]
    speed_m_s: PositiveSpeed


class TaughtAction(Settings):
    """One taught behaviour of a task, with what a knowledge file holds of it: an RLA system as an action."""

    kind: Literal["taught"]
    name: ActionName
    task: str
    """By name (config/tasks), or path to its YAML file: how it perceives, matches and acts."""
    knowledge: Annotated[str, Field(min_length=1)]
    """The file; a path that is not absolute begins at the folder of this repertoire."""
    behaviour: str = ""
    """Which one of the task; left out where it has only one."""


class TaskAction(Settings):
    """A complete task with all its layers, and with what a knowledge file holds of it."""

    kind: Literal["task"]
    name: ActionName
    task: str
    """By name (config/tasks), or path to its YAML file."""
    knowledge: Annotated[str, Field(min_length=1)]
    """The file; a path that is not absolute begins at the folder of this repertoire."""


ActionSettings = Annotated[
    MotorAction | KeepDistanceAction | TurnByAngleAction | TaughtAction | TaskAction, Field(discriminator="kind")
]


class RepertoireSettings(Settings):
    """A pre-defined repertoire of valid actions (paper, III.A.2)."""

    name: str
    actions: Annotated[tuple[ActionSettings, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _names_are_unique(self) -> Self:
        names = [action.name for action in self.actions]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise ValueError(f"two actions share the name {', '.join(twice)}")
        return self
