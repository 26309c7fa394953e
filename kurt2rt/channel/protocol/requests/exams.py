"""The exam of a simulated robot."""

from dataclasses import dataclass
from typing import ClassVar

from kurt2rt.channel.protocol.requests.request import CommandRequest, Request


@dataclass(frozen=True, slots=True)
class ExamRequest(CommandRequest):
    """Examine a copy of the present knowledge, in simulation; the robot itself goes on."""

    path: ClassVar[str] = "/exam"


@dataclass(frozen=True, slots=True)
class ExamStandingRequest(Request):
    """Query of the exam's status."""

    path: ClassVar[str] = "/exam/standing"
