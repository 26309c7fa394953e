"""What teaches, and what is done with lessons."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from kurt2rt.channel.protocol.requests.field_types import Level, Name, NameOrNone, Number, TickOrNone
from kurt2rt.channel.protocol.requests.request import CommandRequest
from kurt2rt.channel.protocol.schema import Flag, OneOf
from kurt2rt.core.rla.rla import BASIC


@dataclass(frozen=True, slots=True)
class AnswerRequest(CommandRequest):
    """Answer a situation (phase 1)."""

    path: ClassVar[str] = "/answer"
    may_lack: ClassVar[int] = 2
    action: Name
    """What is right there: an action for the basic level, a taught behaviour for the mid level."""
    decision_tick: TickOrNone
    """The situation of which tick; None: the present one. So it is with the next three."""
    level: Level = BASIC
    """Whose situation it is."""
    beside: Annotated[bool, Flag()] = False
    """Possible too, beside what the mid level knows there already."""


@dataclass(frozen=True, slots=True)
class CorrectRequest(CommandRequest):
    """Another action is right (phase 2)."""

    path: ClassVar[str] = "/correct"
    may_lack: ClassVar[int] = 1
    action: Name
    decision_tick: TickOrNone
    level: Level = BASIC
    """Whose decision was wrong."""


@dataclass(frozen=True, slots=True)
class RewardRequest(CommandRequest):
    """Praise (+1) or blame (-1)."""

    path: ClassVar[str] = "/reward"
    value: Annotated[int, OneOf((1, -1))]
    decision_tick: TickOrNone


@dataclass(frozen=True, slots=True)
class AppraiseRequest(CommandRequest):
    """Teach the critic what a situation was worth (phase 4)."""

    path: ClassVar[str] = "/appraise"
    appraisal: Name
    """A name of the critic's repertoire."""
    decision_tick: TickOrNone


@dataclass(frozen=True, slots=True)
class ReplaceRequest(CommandRequest):
    """Give one RLA another action."""

    path: ClassVar[str] = "/replace"
    rla_id: Number
    action: Name


@dataclass(frozen=True, slots=True)
class DeleteRequest(CommandRequest):
    """Delete one RLA."""

    path: ClassVar[str] = "/delete"
    rla_id: Number


@dataclass(frozen=True, slots=True)
class NameRequest(CommandRequest):
    """Give the mid level's situation a name, so that it can be a goal."""

    path: ClassVar[str] = "/name"
    name: Name
    decision_tick: TickOrNone
    """The situation of which tick; None: the present one."""


@dataclass(frozen=True, slots=True)
class UndoRequest(CommandRequest):
    """Take a lesson back."""

    path: ClassVar[str] = "/undo"
    lesson: NameOrNone
    """Its command id in the journal; None: the last one that still stands."""
