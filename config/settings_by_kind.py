"""Settings with a `kind` key: each kind has its own module, found by name.

The module `<package>/<kind>.py` holds the class that is named after it: `wall_following` holds `WallFollowingSettings`.
Any other kind is a plug-in, where the caller takes some.
"""

import json
import pkgutil
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TypeVar

from pydantic import ValidationError
from pydantic_core import InitErrorDetails, PydanticCustomError

from config.plugins import PluginError, PluginKind, UnknownPluginError, shelf
from config.settings import Settings, keys_at


class KindSettings(Settings):
    """Base of settings whose key `kind` names their class, such as those of metrics and policies."""

    kind: str


KindT = TypeVar("KindT", bound=KindSettings)


def find_kind(package: str, kind: str, base: type[KindT], plugins: PluginKind | None = None) -> type[KindT]:
    """Return the settings class of a kind: a subclass of `base` in the module `kind` of `package`, or of a plug-in.

    Raises ValueError that lists the kinds, or says why a plug-in cannot be used.
    """
    found = _settings_in(package, kind, base) if kind in _modules(package) else None
    if found is not None:
        return found
    if plugins is None:
        raise ValueError(f"there is no kind {kind!r}; give one of: {', '.join(shipped_kinds(package, base))}")
    try:
        plugin = plugins.find(kind)
    except UnknownPluginError as error:
        raise ValueError(f"there is no kind {kind!r}; {error.do}") from error
    assert isinstance(plugin, type)
    assert issubclass(plugin, base)
    return plugin


def shipped_kinds(package: str, base: type[KindSettings]) -> list[str]:
    """Return the kinds in a package, read and not imported.

    A kind that is broken or being written is no reason to hide that another was misspelled.
    """
    return [each for each in _modules(package) if _is_a_kind(package, each, base)]


def is_settings_class(found: object, base: type[KindSettings]) -> bool:
    """Return whether an object is a class of settings that is derived from `base`."""
    return isinstance(found, type) and issubclass(found, base) and found is not base


def as_its_kind(
    given: object,
    package: str,
    base: type[KindT],
    plugins: PluginKind | None = None,
    stand_in: type[KindT] | None = None,
) -> KindT:
    """Return `given` as an instance of the settings class that its key `kind` names.

    Args:
        given: Mapping with the key `kind` and the settings of that kind, or an instance of `base`, which is returned.
        package: Dotted name of the package with one module per kind, such as behaviors.policies; empty: no kinds but
            those of plug-ins.
        base: Base class of the settings of all kinds in the package.
        plugins: Plug-ins that are taken as well; None: no plug-ins.
        stand_in: Settings that hold any keys, for a plug-in that settings from elsewhere name and that is not here.

    Raises PydanticCustomError or ValidationError, both ValueErrors, that name the key and what is allowed.
    """
    if isinstance(given, base):
        return given
    if not isinstance(given, dict):
        raise PydanticCustomError("model_type", "Input should be an object")
    if "kind" not in given:
        raise PydanticCustomError("union_tag_not_found", "no kind", {"discriminator": "'kind'"})
    named = KindSettings.model_validate_json(json.dumps({"kind": given["kind"]}))
    try:
        schema = find_kind(package, named.kind, base, plugins)
    except ValueError as error:
        if stand_in is not None and not shelf().is_own:
            return stand_in.model_validate_json(json.dumps(given))
        told = f"{error.what}; {error.do}" if isinstance(error, PluginError) else str(error)
        problem = PydanticCustomError("no_such_kind", "{told}", {"told": told})
        raise _refusal(base, [InitErrorDetails(type=problem, loc=("kind",), input=named.kind)]) from error
    try:
        # Through JSON, as the file around it.
        return schema.model_validate_json(json.dumps(given))
    except ValidationError as error:
        raise _refusal(schema, _with_allowed_keys(error, schema)) from error


def _modules(package: str) -> list[str]:
    if not package:
        return []
    return sorted(module.name for module in pkgutil.iter_modules(import_module(package).__path__))


def _class_name(kind: str) -> str:
    return "".join(part.capitalize() for part in kind.split("_")) + "Settings"


def _is_a_kind(package: str, kind: str, base: type[KindSettings]) -> bool:
    spec = find_spec(f"{package}.{kind}")
    if spec is None or spec.origin is None or _class_name(kind) == base.__name__:
        return False
    return f"class {_class_name(kind)}(" in Path(spec.origin).read_text(encoding="utf-8")


def _settings_in(package: str, kind: str, base: type[KindT]) -> type[KindT] | None:
    found = getattr(import_module(f"{package}.{kind}"), _class_name(kind), None)
    # The base itself is in no file of its own kind.
    return found if isinstance(found, type) and is_settings_class(found, base) else None


def _refusal(schema: type[Settings], problems: list[InitErrorDetails]) -> ValidationError:
    return ValidationError.from_exception_data(schema.__name__, problems)


def _with_allowed_keys(error: ValidationError, schema: type[Settings]) -> list[InitErrorDetails]:
    """Return the problems; those with unknown keys list the known ones, which the file's own schema does not know."""
    problems = []
    for each in error.errors(include_url=False):
        told = PydanticCustomError(each["type"], "{told}", {"told": each["msg"]})
        if each["type"] == "extra_forbidden":
            allowed = ", ".join(keys_at(schema, each["loc"][:-1]))
            told = PydanticCustomError("extra_forbidden", "{allowed}", {"allowed": allowed})
        problems.append(InitErrorDetails(type=told, loc=each["loc"], input=each["input"]))
    return problems
