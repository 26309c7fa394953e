"""Checks of the actions, behaviours and RLAs that a command names."""

from collections.abc import Iterable

from kurt2rt.core.outcome import CommandRefusedError, RefusalCode
from kurt2rt.core.rla.rla import Rla
from kurt2rt.core.rla.rla_system import RlaSystem


def require_action(action: str, repertoire: Iterable[str]) -> None:
    """Raise CommandRefusedError, which lists the actions, if the repertoire lacks `action`."""
    names = tuple(repertoire)
    if action not in names:
        raise CommandRefusedError(RefusalCode.NO_ACTION, action=action, known=names)


def require_behaviour(name: str, behaviours: Iterable[str]) -> None:
    """Raise CommandRefusedError, which lists the behaviours, if the task does not teach `name`."""
    names = tuple(behaviours)
    if name not in names:
        raise CommandRefusedError(RefusalCode.NO_BEHAVIOUR, behaviour=name, known=names)


def require_rla(rla_id: int, system: RlaSystem) -> Rla:
    """Return the RLA of an id. Raises CommandRefusedError if `system` has none."""
    rla = system.get(rla_id)
    if rla is None:
        raise CommandRefusedError(RefusalCode.NO_RLA, rla=rla_id)
    return rla
