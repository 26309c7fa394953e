"""Loader of settings: a YAML file becomes a validated, frozen model, or an error of one line."""

import json
import re
import stat
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar, get_args

import yaml
from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import ErrorDetails

from config.errors import UserError, guess


class SettingsError(UserError, ValueError):
    """Error of a settings file that names the file, the key and what is allowed."""


class Settings(BaseModel):
    """Base of every schema: frozen, finite, no unknown key, no silent conversion of types."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


SettingsT = TypeVar("SettingsT", bound=Settings)


class _Strict(yaml.constructor.SafeConstructor):
    """Constructor that refuses two equal keys, of which YAML silently keeps the last."""

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        """Construct an object; name the line of an invalid date such as month 99."""
        try:
            return super().construct_object(node, deep)
        except ValueError as error:
            raise yaml.constructor.ConstructorError(None, None, str(error), node.start_mark) from error


def _construct_mapping(loader: _Strict, node: yaml.MappingNode) -> dict[Any, Any]:
    seen: set[str] = set()
    for key_node, _ in node.value:
        key = loader.construct_object(key_node, deep=True)
        if not isinstance(key, str):
            raise yaml.constructor.ConstructorError(None, None, f"key {key!r} is not a text", key_node.start_mark)
        if key in seen:
            raise yaml.constructor.ConstructorError(None, None, f"key {key!r} stands twice", key_node.start_mark)
        seen.add(key)
    return yaml.SafeLoader.construct_mapping(loader, node, deep=True)


# YAML 1.2, by which ROS and most others write: 5e-2 and 7e2 are numbers. PyYAML, of YAML 1.1, reads texts.
_FLOAT_WITH_EXPONENT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)[eE][-+]?[0-9]+$")
_Strict.add_constructor(yaml.resolver.BaseResolver.DEFAULT_MAPPING_TAG, _construct_mapping)  # type: ignore[type-var]


class _Loader(_Strict, yaml.SafeLoader):
    """Loader in Python."""


class _QuickLoader(_Strict, getattr(yaml, "CSafeLoader", yaml.SafeLoader)):  # type: ignore[misc]
    """Loader of libyaml if PyYAML has it: takes a sixth of the time."""


for _each in (_Loader, _QuickLoader):
    _each.add_implicit_resolver("tag:yaml.org,2002:float", _FLOAT_WITH_EXPONENT, [*"-+.0123456789"])

_MARKS, _MARKS_AT_MOST = "[{-?:", 5000


LARGEST_BYTES = 1_000_000
"""Largest settings file that is read. The largest shipped one has 8 kB; a map's picture is a file of its own."""


def _loaded(text: str) -> Any:
    """Parse YAML. Raises yaml.YAMLError; ValueError for aliases that repeat values too often."""
    # libyaml crashes the process at some 20 000 nested levels, and there is no level without a mark.
    quick = sum(map(text.count, _MARKS)) <= _MARKS_AT_MOST
    content = yaml.load(text, Loader=_QuickLoader if quick else _Loader)
    if "*" in text and _values_in(content, {}) > _MOST_VALUES:  # without an asterisk there is no alias
        raise ValueError(f"its aliases repeat values more than {_MOST_VALUES} times; write the values out")
    return content


_MOST_VALUES = 100_000
"""Most values that a file with aliases may stand for: nine levels of nine aliases each are a billion."""


_CHARACTERS_AS_ONE_VALUE = 100


def _values_in(content: Any, known: dict[int, int]) -> int:
    """Count the values that `content` stands for, each shared part once for each place; `known`: counts by id.

    A long text counts as many values: repeated, it fills the memory just as well.
    """
    if isinstance(content, str):
        return 1 + len(content) // _CHARACTERS_AS_ONE_VALUE
    if not isinstance(content, dict | list):
        return 1
    if id(content) not in known:
        within = (*content, *content.values()) if isinstance(content, dict) else content
        known[id(content)] = 1 + sum(_values_in(each, known) for each in within)
    return known[id(content)]


@lru_cache(maxsize=64)
def _as_json(text: str) -> str:
    """Return YAML as JSON, cached by its text, because the same worlds, tasks and robots are read often.

    Callers cannot change a cached text, as they could change a cached object.
    """
    return json.dumps(_loaded(text), default=str)


def content_of(path: Path) -> Any:
    """Return the unvalidated content of a YAML file, in the types of JSON.

    Raises SettingsError, with one line that names the file, if it cannot be read or is no YAML.
    """
    return json.loads(_json_in(path))


def _json_in(path: Path) -> str:
    """Return the file's content as JSON text. Raises SettingsError."""
    try:
        status = path.stat()
        if stat.S_ISFIFO(status.st_mode):  # reading it would wait until another program writes to it
            raise SettingsError("is a pipe, not a file", where=path, do="give the path of a YAML file")
        if status.st_size > LARGEST_BYTES:
            raise SettingsError(
                f"has {status.st_size} bytes, allowed are {LARGEST_BYTES}",
                where=path,
                do="give the path of a settings file",
            )
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise SettingsError(
            f"cannot be read ({error})", where=path, do="give the path of a readable UTF-8 YAML file"
        ) from error
    try:
        return _as_json(text)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        told = " ".join(str(error).split()).replace(' in "<unicode string>"', "")
        raise SettingsError(f"not valid YAML: {told}", where=path) from error


def load_settings(path: Path, schema: type[SettingsT], changes: Mapping[str, str] | None = None) -> SettingsT:
    """Read `path`, change what `changes` says, and check it against `schema`.

    `changes`: values in YAML by key, with dots between the levels (`learning.radius`, `learning.weights.0.weight`), as
    --set on a command line says.
    Raises SettingsError with one line that names file, key and what is allowed.
    """
    told = _json_in(path)
    if changes:
        content = json.loads(told)
        for key, value in changes.items():
            _change(content, key, _value_of(key, value, path), path)
        told = json.dumps(content)
    return _validated(told, schema, path, changes or {})


def settings_of(content: Mapping[str, Any], schema: type[SettingsT], where: Path | str) -> SettingsT:
    """Return settings of a content in the types of JSON. Raises SettingsError that names `where` and the key."""
    try:
        told = json.dumps(content)
    except (TypeError, ValueError) as error:
        raise SettingsError(f"holds what no YAML file can hold: {error}", where=where) from error
    return _validated(told, schema, where, {})


def _validated(told: str, schema: type[SettingsT], where: Path | str, changes: Mapping[str, str]) -> SettingsT:
    if not told.startswith("{"):
        holds, allowed = type(json.loads(told)).__name__, ", ".join(schema.model_fields)
        raise SettingsError(f"holds {holds}, allowed is a mapping with the keys: {allowed}", where=where)
    try:
        # Through JSON, where strictness still lets a list be a tuple and a string an enum's value.
        return schema.model_validate_json(told)
    except ValidationError as error:
        # A misspelled key also leaves the right one missing: name the misspelling, it is what to mend.
        problems = sorted(error.errors(include_url=False), key=lambda each: each["type"] != "extra_forbidden")
        more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
        explained = " ".join(_explain(problems[0], schema).split())  # a key may hold a line break
        given = _given_by(problems[0], changes)
        raise SettingsError(f"{explained}{more}{given}", where=where) from error


def _value_of(key: str, value: str, path: Path) -> Any:
    try:
        return json.loads(_as_json(value))
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        told = " ".join(str(error).split())
        raise SettingsError(f"{key}: the value {value!r} of --set is not valid YAML: {told}", where=path) from error


def _given_by(problem: ErrorDetails, changes: Mapping[str, str]) -> str:
    """Return the change that causes a problem, because the file itself may be valid."""
    place = [str(part) for part in problem["loc"]]
    for key in changes:
        levels = key.split(".")
        if place and levels[: len(place)] == place[: len(levels)]:
            return f" (set by --set {key})"
    return ""


def _change(content: Any, key: str, value: Any, path: Path) -> None:
    """Set the value of a key; create missing levels, which the schema refuses if they are unknown.

    A level of a list is a position from 0, which has to be there.
    """
    *levels, last = key.split(".")
    for depth, level in enumerate(levels):
        if isinstance(content, dict):
            content = content.setdefault(level, {})
        else:
            content = content[_position(content, level, key, levels[:depth], path)]
    if isinstance(content, dict):
        content[last] = value
    else:
        content[_position(content, last, key, levels, path)] = value


def _position(content: Any, level: str, key: str, above: list[str], path: Path) -> int:
    """Return the position in a list that a level of a key names. Raises SettingsError."""
    if not isinstance(content, list) or not content:
        raise SettingsError(f"{key}: no such key", where=path, do=f"nothing stands within {'.'.join(above)}")
    if not level.isdecimal() or int(level) >= len(content):
        where = ".".join(above)
        raise SettingsError(
            f"{key}: no such key", where=path, do=f"{where} is a list; name a position of 0 to {len(content) - 1}"
        )
    return int(level)


def _explain(problem: ErrorDetails, schema: type[Settings]) -> str:
    key = ".".join(str(part) for part in problem["loc"]) or "(whole file)"
    if problem["type"] == "extra_forbidden":
        allowed = problem.get("ctx", {}).get("allowed") or ", ".join(keys_at(schema, problem["loc"][:-1]))
        return f"{key}: no such key; allowed here: {allowed}{guess(str(problem['loc'][-1]), allowed.split(', '))}"
    if problem["type"] == "missing":
        return f"{key}: this key is missing"
    if problem["type"] == "union_tag_not_found":
        return f"{key}: the key {problem['ctx']['discriminator']} is missing"
    if problem["type"] == "union_tag_invalid":
        return "{key}: the key {discriminator} should be one of {expected_tags} (found {tag!r})".format(
            key=key, **problem["ctx"]
        )
    shown = repr(problem["input"])
    said = problem["msg"].removeprefix("Input ")
    return f"{key}: {said} (found {shown if len(shown) <= 60 else shown[:57] + '...'})"


def keys_at(schema: type[Settings], location: tuple[int | str, ...]) -> list[str]:
    """Return the keys that a nested place allows, as far as the schema's annotations tell.

    `location`: keys and list positions from the outermost in, as pydantic reports them.
    """
    here: list[type[BaseModel]] = [schema]
    for part in location:
        within = [model.model_fields[part].annotation for model in here if part in model.model_fields]
        if within:
            here = [model for annotation in within for model in _models_within(annotation)] or here
        else:  # the position in a list, which all of these share, or the tag of one model of a union
            here = [model for model in here if _carries_tag(model, part)] or here
    return list(here[0].model_fields)


def _models_within(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for argument in get_args(annotation) for model in _models_within(argument)]


def _carries_tag(model: type[BaseModel], tag: int | str) -> bool:
    return any(tag in get_args(field.annotation) for field in model.model_fields.values())
