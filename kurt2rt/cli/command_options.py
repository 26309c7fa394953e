"""Commands whose options are the fields of one dataclass."""

import inspect
from collections.abc import Callable
from dataclasses import MISSING, fields
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

_Options = TypeVar("_Options", bound="DataclassInstance")


def takes_options(options: type[_Options]) -> Callable[[Callable[[_Options], None]], Callable[..., None]]:
    """Return a decorator for a command that takes one `options` record; typer sees a parameter for each field.

    Annotate the fields as typer wants its parameters: `Annotated[TYPE, typer.Option(...)] = DEFAULT`.
    """
    parameters = [
        inspect.Parameter(
            each.name,
            inspect.Parameter.KEYWORD_ONLY,
            default=inspect.Parameter.empty if each.default is MISSING else each.default,
            annotation=each.type,
        )
        for each in fields(options)
    ]

    def decorate(body: Callable[[_Options], None]) -> Callable[..., None]:
        def command(**values: Any) -> None:
            body(options(**values))

        command.__name__, command.__doc__ = body.__name__, body.__doc__
        command.__annotations__ = {each.name: each.annotation for each in parameters}
        vars(command)["__signature__"] = inspect.Signature(parameters)
        return command

    return decorate
