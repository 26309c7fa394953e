"""Conversion of requests to the commands of the tick."""

from kurt2rt.channel.protocol.request_types import CommandRequest
from kurt2rt.channel.protocol.requests import (
    AnswerRequest,
    AppraiseRequest,
    BehaviourRequest,
    CorrectRequest,
    DeleteRequest,
    HandOverRequest,
    LessonSpeedRequest,
    NameRequest,
    PhaseRequest,
    PursueRequest,
    ReplaceRequest,
    ResumeRequest,
    RewardRequest,
    SeekLikeRequest,
    SeekRequest,
    SeekRlaRequest,
    SessionRequest,
    SetLocationRequest,
    ShownRequest,
    TakeRequest,
    UndoRequest,
)
from kurt2rt.core.decision.goal import NamedGoal, PartialGoal, RlaGoal
from kurt2rt.core.teaching.commands import (
    Appraise,
    BeAt,
    BeginSession,
    Command,
    Correct,
    DeleteRla,
    EndSession,
    HandOver,
    NameSituation,
    Pursue,
    ReplaceAction,
    Resume,
    Reward,
    RunBehaviour,
    Seek,
    SetLessonSpeed,
    SetPhase,
    StopSeeking,
    Take,
    Teach,
    TeachShown,
    Undo,
)


def command_of(device: str, command_id: str, request: CommandRequest) -> Command:
    """Return the command of a request, with its device as teacher. Raises AssertionError for one not for the tick."""
    match request:
        case BehaviourRequest(action=action, ticks=ticks):
            return RunBehaviour(command_id, device, action, ticks, request.seen)
        case AnswerRequest(action=action, decision_tick=tick, level=level, alternative=alternative):
            return Teach(command_id, device, action, tick, level, alternative, request.seen)
        case CorrectRequest(action=action, decision_tick=tick, level=level, late=late):
            return Correct(command_id, device, action, tick, level, late, request.seen)
        case ShownRequest(press_id=press_id, segments=segments):
            return TeachShown(command_id, device, press_id, segments)
        case RewardRequest(value=value, decision_tick=tick):
            return Reward(command_id, device, value, tick)
        case AppraiseRequest(appraisal=appraisal, decision_tick=tick):
            return Appraise(command_id, device, appraisal, tick)
        case ReplaceRequest(rla_id=rla_id, action=action):
            return ReplaceAction(command_id, device, rla_id, action)
        case DeleteRequest(rla_id=rla_id):
            return DeleteRla(command_id, device, rla_id)
        case UndoRequest(lesson=lesson):
            return Undo(command_id, device, lesson)
        case PhaseRequest(phase=phase):
            return SetPhase(command_id, device, phase, request.seen)
        case LessonSpeedRequest(percent=percent):
            return SetLessonSpeed(command_id, device, percent / 100)
        case PursueRequest(behaviour=behaviour):
            return Pursue(command_id, device, behaviour, request.seen)
        case NameRequest(name=name, decision_tick=tick):
            return NameSituation(command_id, device, name, tick)
        case SeekRequest(name=None):
            return StopSeeking(command_id, device, request.seen)
        case SeekRequest(name=str(name)):
            return Seek(command_id, device, NamedGoal(name), request.seen)
        case SeekRlaRequest(rla_id=rla_id):
            return Seek(command_id, device, RlaGoal(rla_id), request.seen)
        case SeekLikeRequest(features=features, tolerance=tolerance):
            return Seek(command_id, device, PartialGoal(features, tolerance), request.seen)
        case SetLocationRequest(name=name):
            return BeAt(command_id, device, name, request.seen)
        case SessionRequest(name=None):
            return EndSession(command_id, device)
        case SessionRequest(name=str(name)):
            return BeginSession(command_id, device, name)
        case ResumeRequest():
            return Resume(command_id, device, request.seen)
        case TakeRequest():
            return Take(command_id, device)
        case HandOverRequest(to=to):
            return HandOver(command_id, device, to)
    raise AssertionError(f"{request.path} is no command for the tick")
