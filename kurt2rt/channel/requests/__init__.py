"""What a teacher's device can ask of the robot: one request per path, and the checks of its fields."""

from dataclasses import fields
from typing import get_args, get_type_hints

from kurt2rt.channel.requests.exams import ExamRequest, ExamStandingRequest
from kurt2rt.channel.requests.goals import BeAtRequest, PursueRequest, SeekLikeRequest, SeekRequest, SeekRlaRequest
from kurt2rt.channel.requests.lessons import (
    AnswerRequest,
    AppraiseRequest,
    CorrectRequest,
    DeleteRequest,
    NameRequest,
    ReplaceRequest,
    RewardRequest,
    UndoRequest,
)
from kurt2rt.channel.requests.limits import (
    BOOT_BYTES,
    COMMAND_ID_BYTES,
    HIGHEST_SPEED_M_S,
    LARGEST_NUMBER,
    LONGEST_BEHAVIOUR_TICKS,
    LONGEST_TEXT,
    LONGEST_WAY_M,
    MOST_GOAL_FEATURES,
    MOST_LESSONS,
    MOST_SITUATIONS,
    PART_BYTES,
    VERSION,
)
from kurt2rt.channel.requests.moving import BehaviourRequest, DriveRequest, ResumeRequest, StopRequest, WatchRequest
from kurt2rt.channel.requests.organising import (
    PACKAGE,
    TABLE,
    ExportRequest,
    PhaseRequest,
    ReleaseRequest,
    SaveRequest,
    SessionRequest,
    TakeRequest,
)
from kurt2rt.channel.requests.reading import (
    FileRequest,
    HealthRequest,
    HelloRequest,
    LessonsRequest,
    SituationsRequest,
    WhyRequest,
)
from kurt2rt.channel.requests.request import CommandRequest, Request, StreamRequest
from kurt2rt.channel.requests.simulation import BackToStartRequest, NextRunRequest, SimulationRequest
from kurt2rt.channel.requests.world import MoveWallRequest, PlaceRequest, WorldRequest
from kurt2rt.channel.schema import Check

__all__ = [
    "BOOT_BYTES",
    "COMMAND_ID_BYTES",
    "HIGHEST_SPEED_M_S",
    "LARGEST_NUMBER",
    "LONGEST_BEHAVIOUR_TICKS",
    "LONGEST_TEXT",
    "LONGEST_WAY_M",
    "MOST_GOAL_FEATURES",
    "MOST_LESSONS",
    "MOST_SITUATIONS",
    "PACKAGE",
    "PART_BYTES",
    "REQUESTS",
    "TABLE",
    "VERSION",
    "AnswerRequest",
    "AppraiseRequest",
    "BackToStartRequest",
    "BeAtRequest",
    "BehaviourRequest",
    "CommandRequest",
    "CorrectRequest",
    "DeleteRequest",
    "DriveRequest",
    "ExamRequest",
    "ExamStandingRequest",
    "ExportRequest",
    "FileRequest",
    "HealthRequest",
    "HelloRequest",
    "LessonsRequest",
    "MoveWallRequest",
    "NameRequest",
    "NextRunRequest",
    "PhaseRequest",
    "PlaceRequest",
    "PursueRequest",
    "ReleaseRequest",
    "ReplaceRequest",
    "Request",
    "ResumeRequest",
    "RewardRequest",
    "SaveRequest",
    "SeekLikeRequest",
    "SeekRequest",
    "SeekRlaRequest",
    "SessionRequest",
    "SimulationRequest",
    "SituationsRequest",
    "StopRequest",
    "StreamRequest",
    "TakeRequest",
    "UndoRequest",
    "WatchRequest",
    "WhyRequest",
    "WorldRequest",
    "checks_of",
]

REQUESTS: tuple[type[Request], ...] = (
    HelloRequest,
    WatchRequest,
    DriveRequest,
    StopRequest,
    BehaviourRequest,
    AnswerRequest,
    CorrectRequest,
    RewardRequest,
    AppraiseRequest,
    ReplaceRequest,
    DeleteRequest,
    UndoRequest,
    PhaseRequest,
    PursueRequest,
    NameRequest,
    SeekRequest,
    SeekRlaRequest,
    SeekLikeRequest,
    BeAtRequest,
    SituationsRequest,
    SessionRequest,
    ResumeRequest,
    TakeRequest,
    ReleaseRequest,
    SaveRequest,
    ExportRequest,
    FileRequest,
    ExamRequest,
    ExamStandingRequest,
    LessonsRequest,
    HealthRequest,
    WhyRequest,
    WorldRequest,
    MoveWallRequest,
    PlaceRequest,
    BackToStartRequest,
    SimulationRequest,
    NextRunRequest,
)


def checks_of(kind: type[Request]) -> tuple[tuple[str, Check], ...]:
    """The fields of a request in the order of its body, each with the check it has to pass."""
    hints = get_type_hints(kind, include_extras=True)
    return tuple((each.name, get_args(hints[each.name])[1]) for each in fields(kind))
