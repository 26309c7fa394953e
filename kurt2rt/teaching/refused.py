"""A command that is not carried out."""


class RefusedError(Exception):
    """Why a command is not carried out, in a sentence for the teacher."""


def refuse(reason: str | None) -> None:
    """Raises RefusedError where there is a reason."""
    if reason is not None:
        raise RefusedError(reason)
