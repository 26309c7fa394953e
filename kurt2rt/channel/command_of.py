"""From a request on the wire to the command that the tick takes."""

from kurt2rt.channel.requests import (
    AnswerRequest,
    AppraiseRequest,
    BehaviourRequest,
    CommandRequest,
    CorrectRequest,
    DeleteRequest,
    PhaseRequest,
    PursueRequest,
    ReleaseRequest,
    ReplaceRequest,
    ResumeRequest,
    RewardRequest,
    SessionRequest,
    TakeRequest,
    UndoRequest,
)
from kurt2rt.teaching.commands import (
    Appraise,
    BeginSession,
    Command,
    Correct,
    DeleteRla,
    EndSession,
    HandOver,
    Pursue,
    ReplaceAction,
    Resume,
    Reward,
    RunBehaviour,
    SetPhase,
    Take,
    Teach,
    Undo,
)


def command_of(device: str, command_id: str, request: CommandRequest) -> Command:
    """The command that a request asks for."""
    match request:
        case BehaviourRequest(action=action, ticks=ticks):
            return RunBehaviour(command_id, device, action, ticks, request.seen)
        case AnswerRequest(action=action, decision_tick=tick):
            return Teach(command_id, device, action, tick)
        case CorrectRequest(action=action, decision_tick=tick):
            return Correct(command_id, device, action, tick)
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
        case PursueRequest(behaviour=behaviour):
            return Pursue(command_id, device, behaviour, request.seen)
        case SessionRequest(name=None):
            return EndSession(command_id, device)
        case SessionRequest(name=str(name)):
            return BeginSession(command_id, device, name)
        case ResumeRequest():
            return Resume(command_id, device, request.seen)
        case TakeRequest():
            return Take(command_id, device)
        case ReleaseRequest(to=to):
            return HandOver(command_id, device, to)
    raise AssertionError(f"{request.path} is no command for the tick")
