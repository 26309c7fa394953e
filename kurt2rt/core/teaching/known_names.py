"""Checks of the names of actions and behaviours in a command."""

from collections.abc import Iterable

from kurt2rt.core.outcome import CommandRefusedError, RefusalCode


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
