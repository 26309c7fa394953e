"""Readable error of a part of the library whose extra is not installed."""

from collections.abc import Iterator
from contextlib import contextmanager

from config.errors import UserError
from kurt2rt.platform.extras import extra_for


@contextmanager
def extra_named() -> Iterator[None]:
    """Raise UserError (kurt2rt.Error) with the extra's name if an import in the block lacks its package."""
    try:
        yield
    except ModuleNotFoundError as error:
        extra = extra_for(error)
        if extra is None:
            raise
        raise UserError(f"{error.name} is not installed", where=extra, do=f"install the extra {extra!r}") from error
