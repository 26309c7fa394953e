"""Typed words of a command, for reports and records."""

import shlex
from collections.abc import Iterator, Mapping
from dataclasses import MISSING, Field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

from typer.models import ArgumentInfo, OptionInfo

from config.settings_files import YAML_SUFFIXES

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

_LEFT_OUT = {"jobs", "cluster", "out", "engine", "as_json"}
"""Options that decide no number, unless a command states them."""


def typed_command(command: str, options: "DataclassInstance", instead: Mapping[str, object] | None = None) -> str:
    """Return a command as far as it decides the numbers, without paths of this machine.

    Args:
        command: its name.
        options: its options, as `takes_options` makes them; those with their default are left out.
        instead: values of fields instead of the typed ones; they are stated also if they are the default or decide no
            number in other commands, None never.
    """
    stated = instead or {}
    words = [f"kurt2rt {command}"]
    for each in fields(options):
        value = stated.get(each.name, getattr(options, each.name))
        default = None if each.default is MISSING or each.name in stated else each.default
        if (each.name in stated or each.name not in _LEFT_OUT) and value != default:
            words += _words(each, value)
    return " ".join(words)


def _words(field: "Field[Any]", value: object) -> Iterator[str]:
    (info,) = get_args(field.type)[1:]
    if isinstance(info, ArgumentInfo):
        yield _text(value)
        return
    name = _name_of(info) or f"--{field.name.replace('_', '-')}"
    if isinstance(value, bool):
        yield name.split("/")[0 if value else 1]
        return
    values: list[object] = value if isinstance(value, list) else [value]
    for each in values:
        yield f"{name} {_text(each)}"


def _name_of(info: OptionInfo) -> str:
    """Return the name that an option was given; empty if it has that of its field.

    Within Annotated the first name is where typer has the default of an option outside of it.
    """
    names = [each for each in (info.default, *(info.param_decls or ())) if isinstance(each, str)]
    return names[0] if names else ""


def _text(value: object) -> str:
    """Return a value as it is typed; of a file only its name, which is the same on all machines.

    A name of a robot's plug-in, such as `school/fleeing`, stays whole.
    """
    text = f"{value:g}" if isinstance(value, float) else str(value)
    is_file = "=" not in text and (isinstance(value, Path) or text.endswith(YAML_SUFFIXES))
    return shlex.quote(Path(text).name if is_file else text)
