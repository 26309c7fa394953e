"""Who teaches, in which phase and session, and what is kept."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from kurt2rt.channel.protocol.requests.field_types import NameOrNone
from kurt2rt.channel.protocol.requests.limits import LONGEST_TEXT
from kurt2rt.channel.protocol.requests.request import CommandRequest
from kurt2rt.channel.protocol.schema import OneOf, OneWord, Text
from kurt2rt.core.rla.rla import Phase

TABLE, PACKAGE = "table", "package"
"""Forms of an export: CSV, and the archive of `kurt2rt knowledge export`."""


@dataclass(frozen=True, slots=True)
class PhaseRequest(CommandRequest):
    """Another training phase."""

    path: ClassVar[str] = "/phase"
    phase: Annotated[Phase, OneOf(tuple(each.value for each in Phase), Phase)]


@dataclass(frozen=True, slots=True)
class SessionRequest(CommandRequest):
    """Teaching begins under a name, or ends (None)."""

    path: ClassVar[str] = "/session"
    name: NameOrNone


@dataclass(frozen=True, slots=True)
class TakeRequest(CommandRequest):
    """Be the teacher from now on."""

    path: ClassVar[str] = "/take"


@dataclass(frozen=True, slots=True)
class ReleaseRequest(CommandRequest):
    """Be the teacher no longer."""

    path: ClassVar[str] = "/release"
    to: NameOrNone
    """Who is the teacher next; None: whoever takes it."""


@dataclass(frozen=True, slots=True)
class SaveRequest(CommandRequest):
    """A copy of the knowledge on the robot."""

    path: ClassVar[str] = "/save"
    label: Annotated[str, Text(LONGEST_TEXT)]


@dataclass(frozen=True, slots=True)
class ExportRequest(CommandRequest):
    """The RLAs as a readable table on the robot, or all of the knowledge as one file to give away."""

    path: ClassVar[str] = "/export"
    may_lack: ClassVar[int] = 1
    form: Annotated[str, OneWord((TABLE, PACKAGE))] = TABLE
