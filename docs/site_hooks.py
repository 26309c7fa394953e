"""Hooks of the site (mkdocs.yml): pages of the checkout's root, and pages that are generated from the code."""

import re
from collections.abc import Iterator, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import typer
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from typer.cli import get_docs_for_click

from config.settings import Settings
from kurt2rt.cli.command_line import command_line

ROOT = Path(__file__).parents[1]
AT_THE_ROOT = ("CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "CITATION.cff", "Makefile")
# The schemas, which are imported later, take the texts below their fields along; a robot starts sooner without.
Settings.model_config["use_attribute_docstrings"] = True

_ABOVE = re.compile(r"\]\(\.\./([^)#]+)")
"""Link from `docs` to a file of the checkout."""
SCHEMAS = {
    "Task": ("config/tasks", "kurt2rt.core.task_settings", "TaskSettings"),
    "Teacher": ("config/teachers", "kurt2rt.core.teacher_settings", "TeacherProfile"),
    "Runtime and service": ("config/runtime", "kurt2rt.service.settings", "ServiceSettings"),
    "Robot KURT2": ("config/robots", "hal.kurt2_settings", "Kurt2Settings"),
    "World": ("config/worlds", "simbridge.worlds.world_settings", "WorldSettings"),
    "Situation": ("config/situations", "kurt2rt.core.perception.definition", "SituationDefinition"),
    "Repertoire": ("config/repertoires", "behaviors.repertoire_settings", "RepertoireSettings"),
    "Critic": ("config/critics", "kurt2rt.core.critic.settings", "CriticSettings"),
    "Search": ("config/searches", "kurt2rt.experiments.search.settings", "SearchSettings"),
}
"""Kind of a settings file: its folder, and the module and class of its schema."""


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that do not stand in `docs`, and the files that its pages link to."""
    linked = {name for page in files.documentation_pages() for name in _ABOVE.findall(page.content_string)}
    pages = {name: (ROOT / name).read_text(encoding="utf-8") for name in linked | {*AT_THE_ROOT}}
    pages["index.md"] = (ROOT / "README.md").read_text(encoding="utf-8")
    pages = {name: text.replace("](docs/", "](") for name, text in pages.items()}
    pages["command-line.md"] = "\n".join(command_line_page())
    pages["settings.md"] = "\n".join(settings_page())
    for name, text in pages.items():
        files.append(File.generated(config, name, content=text))
    return files


def on_page_markdown(markdown: str, **_: object) -> str:
    """Let links to files of the checkout lead to their copies."""
    return _ABOVE.sub(r"](\1", markdown)


def command_line_page() -> Iterator[str]:
    """Yield the help of all commands as Markdown."""
    group = typer.main.get_command(command_line())
    context = typer.Context(group, info_name="kurt2rt")
    yield get_docs_for_click(obj=group, ctx=context, name="kurt2rt", title="Command line")


def settings_page() -> Iterator[str]:
    """Yield a table for each settings file and each of its parts."""
    told: set[str] = set()
    yield from ("# Settings", "", "Every key of every settings file, from the program itself.")
    for kind, (folder, module, name) in SCHEMAS.items():
        schema = getattr(import_module(module), name).model_json_schema()
        parts = schema.get("$defs", {})
        yield from ("", f"## {kind}", "", f"Files in `{folder}`, or one of your own.", *_table(schema, parts))
        for part, fields in parts.items():
            if "properties" in fields and part not in told:
                told.add(part)
                what = fields.get("description", "").partition("\n")[0]
                yield from ("", f"### {part}", "", what, *_table(fields, parts))


def _table(schema: Mapping[str, Any], parts: Mapping[str, Any]) -> Iterator[str]:
    yield from ("", "| key | value | default | meaning |", "| --- | --- | --- | --- |")
    for key, field in schema.get("properties", {}).items():
        default = "needed" if key in schema.get("required", ()) else _default(field.get("default"))
        meaning = " ".join(field.get("description", "").split())
        yield f"| `{key}` | {_kind(field, parts)} | {default} | {meaning} |".replace("\n", " ")


def _default(value: object) -> str:
    if isinstance(value, dict):
        return "as in its table"
    return "none" if value is None or value in ("", [], [""]) else f"`{value}`"


def _kind(field: Mapping[str, Any], parts: Mapping[str, Any]) -> str:
    """Return the type and the limits of a value, in words."""
    if "$ref" in field:
        name = field["$ref"].rpartition("/")[2]
        return f"[{name}](#{name.lower()})" if "properties" in parts[name] else _kind(parts[name], parts)
    if choices := field.get("anyOf") or field.get("oneOf"):
        return " or ".join(_kind(each, parts) for each in choices)
    if "enum" in field or "const" in field:
        return ", ".join(f"`{each}`" for each in field.get("enum", [field.get("const")]))
    if field.get("type") == "array":
        return f"list of {_kind(field.get('items', {}), parts)}"
    limits = [
        f"{word} {field[key]:g}"
        for key, word in (("minimum", "from"), ("exclusiveMinimum", "above"), ("maximum", "to"))
        if key in field
    ]
    return " ".join([field.get("type", "any"), *limits])
