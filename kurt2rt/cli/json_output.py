"""--json, with one meaning in every command that reports: one JSON document on standard output, and nothing else."""

import dataclasses
import json
import math
from collections.abc import Mapping
from datetime import datetime
from enum import Enum
from pathlib import Path
from typing import Annotated, Any

import typer

AsJson = Annotated[
    bool,
    typer.Option(
        "--json",
        help="Print the result as one JSON document, and nothing else, on standard output; the exit code stays.",
    ),
]


def print_json(value: object) -> None:
    """Print a value, as `plain` returns it, as one JSON document on standard output.

    Raises TypeError for a value that `plain` does not know.
    """
    typer.echo(json.dumps(plain(value), indent=2, allow_nan=False))


def plain(value: Any) -> Any:
    """Return dicts, lists, texts and numbers for a value; a number that JSON does not have becomes null.

    Raises TypeError for anything but dataclasses, named tuples, mappings, sequences, enums, paths, times and numbers.
    """
    match value:
        case Enum():
            return plain(value.value)
        case float():
            return value if math.isfinite(value) else None
        case None | bool() | int() | str():
            return value
        case Path():
            return str(value)
        case datetime():
            return value.isoformat()
        case Mapping():
            return {str(plain(key)): plain(each) for key, each in value.items()}
        case tuple() if hasattr(value, "_asdict"):
            return plain(value._asdict())
        case list() | tuple() | set() | frozenset():
            return [plain(each) for each in value]
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {field.name: plain(getattr(value, field.name)) for field in dataclasses.fields(value)}
    raise TypeError(f"no JSON for {type(value).__name__}")
