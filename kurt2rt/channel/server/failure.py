"""Outcomes of failed work: codes of the errors of knowledge and of the simulated world, as a teacher gets them."""

from collections.abc import Mapping

from config.errors import UserError
from kurt2rt.core.outcome import CommandRefusedError, Outcome, RefusalCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from simbridge.contracts.world_refusal import WorldRefusal

WORLD_REFUSALS: Mapping[WorldRefusal, RefusalCode] = {
    WorldRefusal.NO_WALL: RefusalCode.NO_WALL,
    WorldRefusal.WALL_ON_ROBOT: RefusalCode.WALL_ON_ROBOT,
    WorldRefusal.NO_ROOM: RefusalCode.NO_ROOM,
    WorldRefusal.START_BLOCKED: RefusalCode.START_BLOCKED,
}


def failure(failed: RefusalCode, crashed: RefusalCode, error: Exception) -> Outcome:
    """Return the outcome of work that failed.

    Args:
        failed: code for an error that the teacher can mend.
        crashed: code for an error of the program, which is shown as repr.
        error: a refusal keeps its own code.
    """
    if isinstance(error, CommandRefusedError):
        return error.outcome
    if isinstance(error, UserError):
        return known_failure(failed, error)
    return Outcome.of(crashed, error=_line(repr(error)))


def known_failure(code: RefusalCode, error: UserError) -> Outcome:
    """Return the outcome of an error that the teacher can mend.

    `cause` is the code of a knowledge error, else empty; `where` its file; `says` its line in the words of its table.
    """
    return Outcome.of(
        code,
        cause=error.code.value if isinstance(error, KnowledgeError) else "",
        where=error.where,
        says=_line(str(error)),
    )


def _line(text: str) -> str:
    return " ".join(text.split())
