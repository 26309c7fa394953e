"""Builders of commands of teacher Ann."""

from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.teaching.commands import Correct, DeleteRla, Pursue, ReplaceAction, Resume, SetPhase, Stop, Teach


def teach(action: str, command_id: str = "t") -> Teach:
    return Teach(command_id, "Ann", action)


def correct(action: str, command_id: str = "c") -> Correct:
    return Correct(command_id, "Ann", action)


def replace_action(rla_id: int, action: str, command_id: str = "r") -> ReplaceAction:
    return ReplaceAction(command_id, "Ann", rla_id, action)


def delete(rla_id: int, command_id: str = "d") -> DeleteRla:
    return DeleteRla(command_id, "Ann", rla_id)


def stop(command_id: str = "stop") -> Stop:
    return Stop(command_id, "Ann")


def resume(command_id: str = "resume") -> Resume:
    return Resume(command_id, "Ann")


def set_phase(phase: Phase, command_id: str = "phase") -> SetPhase:
    return SetPhase(command_id, "Ann", phase)


def pursue(behaviour: str, command_id: str = "pursue") -> Pursue:
    return Pursue(command_id, "Ann", behaviour)
