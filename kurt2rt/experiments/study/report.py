"""Report of a study: one HTML file that holds everything. It needs no other, and nothing from elsewhere."""

import base64
import re
from collections.abc import Sequence
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

import jinja2

from kurt2rt.experiments.study.figures import SavedFigure
from kurt2rt.experiments.study.provenance import source_hash, versions_with_python
from kurt2rt.experiments.study.table import Table, Told
from kurt2rt.platform.durable_files import write_durably

_MADE_WITH = ("kurt2rt", "matplotlib", "jinja2")
_SAME = "The same command with the same versions gives the same numbers on the same kind of machine."
TO_SEE_LESSONS = (
    "What a robot was taught: `kurt2rt knowledge show` with a file of the folder `knowledge` next to this report."
)


class Section(NamedTuple):
    """Section of a study's report: a heading, texts, tables and pictures.

    Between backticks in a text stands what is typed.
    """

    heading: str
    """Empty: it goes on with the section before."""
    texts: Sequence[str] = ()
    tables: Sequence[Table] = ()
    pictures: Sequence[SavedFigure] = ()


def tell_with_report(
    folder: Path,
    title: str,
    told: Told,
    command: str,
    pictures: Sequence[SavedFigure] = (),
    more: Sequence[Section] = (),
    footer: str = "",
) -> Told:
    """Write the report of a study as an HTML page, report.html, into `folder`; return `told` with it.

    Its sentence and the first picture come before all else, then its reasons against judging, what was done, all its
    tables, and the other pictures. `more`: sections behind these. `command`: typed words, without those that belong to
    the machine alone. `footer`: what follows the versions. Raises OSError.
    """
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("kurt2rt.experiments.study", ""),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"typed": _typed, "uri": _as_uri}
    sections = (
        Section("", (told.sentence,), pictures=pictures[:1]),
        Section("", told.about),
        Section("Tables", tables=told.tables),
        *([Section("Figures", pictures=pictures[1:])] if pictures[1:] else ()),
        *more,
    )
    made_with = ", ".join([versions_with_python(), *(f"{name} {version(name)}" for name in _MADE_WITH)])
    html = environment.get_template("report.html.j2").render(
        title=title,
        sections=sections,
        reasons=told.not_judged,
        command=command,
        footer=f"{made_with}. Source: {source_hash()}. {_SAME} {footer}",
    )
    path = folder / "report.html"
    write_durably(path, html)
    return replace(told, files={**told.files, "report": path})


def spans(seeds: Sequence[int]) -> str:
    """Return ascending seeds as a user types them with --seeds: 100-119, or 1,5,7."""
    first, last = seeds[0], seeds[-1]
    if len(seeds) > 1 and list(seeds) == list(range(first, last + 1)):
        return f"{first}-{last}"
    return ",".join(map(str, seeds))


def _typed(text: str) -> str:
    """Return escaped text with marks around what is typed, in place of backticks."""
    return re.sub("`(.+?)`", r"<code>\1</code>", str(text))  # markup would escape the marks


def _as_uri(path: Path) -> str:
    return f"data:image/png;base64,{base64.b64encode(path.read_bytes()).decode()}"
