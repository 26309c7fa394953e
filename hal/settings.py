"""The one loader of settings: a YAML file becomes a checked, frozen model, or one clear line says why not."""

import json
from pathlib import Path
from typing import Any, TypeVar

import yaml
from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import ErrorDetails

from config import CONFIG_DIR


class SettingsError(ValueError):
    """A settings file cannot be used. The message is one line: file, key, what is wrong, what is allowed."""


class Settings(BaseModel):
    """Base of every schema: frozen, finite, no unknown key, no silent conversion of types."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


SettingsT = TypeVar("SettingsT", bound=Settings)


class _UniqueKeyLoader(yaml.SafeLoader):
    """YAML keeps the last of two equal keys without a word; a settings file with two is a mistake."""


def _construct_mapping(loader: _UniqueKeyLoader, node: yaml.MappingNode) -> dict[Any, Any]:
    seen: set[Any] = set()
    for key_node, _ in node.value:
        key = loader.construct_object(key_node)
        if key in seen:
            raise yaml.constructor.ConstructorError(None, None, f"key {key!r} stands twice", key_node.start_mark)
        seen.add(key)
    return yaml.SafeLoader.construct_mapping(loader, node, deep=True)


_UniqueKeyLoader.add_constructor(yaml.resolver.BaseResolver.DEFAULT_MAPPING_TAG, _construct_mapping)


def find_config(kind: str, name_or_path: str) -> Path:
    """Path of a settings file: a path that exists, or the shipped `config/<kind>/<name>.yaml`.

    Raises SettingsError that lists the shipped names when there is no such file.
    """
    given = Path(name_or_path)
    if given.suffix == ".yaml" and given.is_file():
        return given
    shipped = CONFIG_DIR / kind / f"{name_or_path}.yaml"
    if shipped.is_file():
        return shipped
    names = ", ".join(sorted(path.stem for path in (CONFIG_DIR / kind).glob("*.yaml")))
    raise SettingsError(f"{name_or_path}: no such file in {kind}; give a path to a .yaml file or one of: {names}")


def load_settings(path: Path, schema: type[SettingsT]) -> SettingsT:
    """Read `path` and check it against `schema`.

    Raises SettingsError with one line that names file, key and what is allowed.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise SettingsError(f"{path}: cannot be read ({error}); give the path of a readable UTF-8 YAML file") from error
    try:
        content = yaml.load(text, Loader=_UniqueKeyLoader)
    except yaml.YAMLError as error:
        raise SettingsError(f"{path}: not valid YAML: {' '.join(str(error).split())}") from error
    if not isinstance(content, dict):
        allowed = ", ".join(schema.model_fields)
        raise SettingsError(f"{path}: holds {type(content).__name__}, allowed is a mapping with the keys: {allowed}")
    try:
        # Through JSON, where strictness still lets a list be a tuple and a string an enum's value.
        return schema.model_validate_json(json.dumps(content, default=str))
    except ValidationError as error:
        # A misspelled key also leaves the right one missing: name the misspelling, it is what to mend.
        problems = sorted(error.errors(include_url=False), key=lambda each: each["type"] != "extra_forbidden")
        more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
        raise SettingsError(f"{path}: {_explain(problems[0], schema)}{more}") from error


def _explain(problem: ErrorDetails, schema: type[Settings]) -> str:
    key = ".".join(str(part) for part in problem["loc"]) or "(whole file)"
    if problem["type"] == "extra_forbidden":
        return f"{key}: no such key; allowed here: {', '.join(_keys_at(schema, problem['loc'][:-1]))}"
    if problem["type"] == "missing":
        return f"{key}: this key is missing"
    shown = repr(problem["input"])
    return f"{key}: {problem['msg']} (found {shown if len(shown) <= 60 else shown[:57] + '...'})"


def _keys_at(schema: type[Settings], location: tuple[int | str, ...]) -> list[str]:
    """Names of the keys that a nested place allows, as far as the schema's annotations tell."""
    here: Any = schema
    for part in location:
        if isinstance(part, int) or not (isinstance(here, type) and issubclass(here, BaseModel)):
            continue
        field = here.model_fields.get(part)
        if field is None:  # a tag of a union, not a key
            continue
        here = _model_within(field.annotation) or here
    return list(here.model_fields)


def _model_within(annotation: Any) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    for argument in getattr(annotation, "__args__", ()):
        found = _model_within(argument)
        if found is not None:
            return found
    return None
