"""Schema of `config/repertoires/*.yaml`, the actions that a teacher may choose."""

from abc import abstractmethod
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Discriminator, Field, PlainValidator, SerializeAsAny, Tag, model_validator

from behaviors.behaviour import Behaviour
from config.plugins import PluginKind
from config.settings import Settings
from config.settings_by_kind import KindSettings, as_its_kind, is_settings_class
from hal.robot_settings import RobotSettings

Speed = Annotated[float, Field(ge=-1.0, le=1.0)]
PositiveSpeed = Annotated[float, Field(gt=0, le=1.0)]
RESERVED = "ask"
"""Placeholder of a withdrawn action (kurt2rt.core.rla.rla.ASK)."""


def _require_free(name: str) -> str:
    if name == RESERVED:
        raise ValueError(
            f"{RESERVED} stands for an action that was withdrawn, where the robot asks; give the action another name"
        )
    return name


ActionName = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,39}$"), AfterValidator(_require_free)]


class MotorAction(Settings):
    """Entry of a repertoire: fixed speeds of both sides in m/s until another action drives."""

    kind: Literal["motor"]
    name: ActionName
    left_m_s: Speed
    right_m_s: Speed


class KeepDistanceAction(Settings):
    """Entry of a repertoire: a control loop that keeps `distance_m` from a wall (behaviors.keep_distance).

    The robot drives at `speed_m_s`; the wall lies on the side to which both sensors look, in front and at the back.
    """

    kind: Literal["keep_distance"]
    name: ActionName
    front_sensor: str
    back_sensor: str
    distance_m: Annotated[float, Field(ge=0.1, le=0.6)]
    speed_m_s: PositiveSpeed
    gain_per_m: Annotated[float, Field(gt=0, le=50)]


class TurnByAngleAction(Settings):
    """Entry of a repertoire: a turn on the spot by `angle_deg`, left positive, which ends by itself."""

    kind: Literal["turn_by_angle"]
    name: ActionName
    angle_deg: Annotated[float, Field(ge=-360, le=360)]
    speed_m_s: PositiveSpeed


class TaughtAction(Settings):
    """One taught behaviour of a task with its lessons from a knowledge file: an RLA system as an action."""

    kind: Literal["taught"]
    name: ActionName
    task: str
    """Name in config/tasks or path of a YAML file; it sets perception, match and actions."""
    knowledge: Annotated[str, Field(min_length=1)]
    """Knowledge file; a relative path starts at the folder of this repertoire."""
    behaviour: str = ""
    """Taught behaviour of the task; empty if the task has only one."""


class TaskAction(Settings):
    """Complete task with all layers and the lessons of a knowledge file."""

    kind: Literal["task"]
    name: ActionName
    task: str
    """Name in config/tasks or path of a YAML file."""
    knowledge: Annotated[str, Field(min_length=1)]
    """Knowledge file; a relative path starts at the folder of this repertoire."""


class PluginAction(KindSettings):
    """Base of the settings of an action that a plug-in offers."""

    name: ActionName

    @abstractmethod
    def build(self, robot: RobotSettings) -> Behaviour:
        """Return the action for a robot. Raises ValueError for settings that do not fit the robot."""


_SHIPPED = ("motor", "keep_distance", "turn_by_angle", "taught", "task")
_PLUGIN = "plugin"
BEHAVIOURS = PluginKind(
    "behaviours",
    "action",
    "a subclass of PluginAction (behaviors.repertoire_settings)",
    lambda found: is_settings_class(found, PluginAction),
    lambda: _SHIPPED,
)


def _tag_of(given: object) -> str | None:
    kind = given.get("kind") if isinstance(given, dict) else getattr(given, "kind", None)
    return None if kind is None else kind if kind in _SHIPPED else _PLUGIN


def _checked_plugin(given: object) -> PluginAction:
    return as_its_kind(given, "", PluginAction, BEHAVIOURS)  # type: ignore[type-abstract]


ActionSettings = Annotated[
    Annotated[MotorAction, Tag("motor")]
    | Annotated[KeepDistanceAction, Tag("keep_distance")]
    | Annotated[TurnByAngleAction, Tag("turn_by_angle")]
    | Annotated[TaughtAction, Tag("taught")]
    | Annotated[TaskAction, Tag("task")]
    | Annotated[SerializeAsAny[PluginAction], PlainValidator(_checked_plugin), Tag(_PLUGIN)],
    Discriminator(
        _tag_of,
        custom_error_type="union_tag_not_found",
        custom_error_context={"discriminator": "'kind'"},
    ),
]


class RepertoireSettings(Settings):
    """Schema of a repertoire's file: the actions that teachers may choose (paper, III.A.2)."""

    name: str
    actions: Annotated[tuple[ActionSettings, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _names_are_unique(self) -> Self:
        names = [action.name for action in self.actions]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise ValueError(f"two actions share the name {', '.join(twice)}")
        return self
