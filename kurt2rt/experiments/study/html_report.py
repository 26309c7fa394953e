"""One HTML file that holds everything: it needs no other, and nothing from elsewhere."""

import base64
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

import jinja2

from kurt2rt.experiments.study.figure import SavedFigure
from kurt2rt.experiments.study.provenance import versions
from kurt2rt.platform.durable_files import write_durably

_HERE = "kurt2rt.experiments.study"
_MADE_WITH = ("kurt2rt", "matplotlib", "jinja2")


def write_page(
    path: Path, package: str, template: str, title: str, pictures: Sequence[SavedFigure], **what: object
) -> None:
    """Fill a template of `package`, which extends `page.html.j2` of this one, and write the page to `path`.

    `what`: values for the template. Raises OSError.
    """
    environment = jinja2.Environment(
        loader=jinja2.ChoiceLoader([jinja2.PackageLoader(package, ""), jinja2.PackageLoader(_HERE, "")]),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    html = environment.get_template(template).render(
        title=title,
        pictures=[(each, _as_uri(each.path)) for each in pictures],
        versions=", ".join([versions(), *(f"{name} {version(name)}" for name in _MADE_WITH)]),
        **what,
    )
    write_durably(path, html)


def spans(seeds: Sequence[int]) -> str:
    """Return seeds as a user types them: 100-119, or 1,5,7."""
    first, last = seeds[0], seeds[-1]
    if len(seeds) > 1 and list(seeds) == list(range(first, last + 1)):
        return f"{first}-{last}"
    return ",".join(map(str, seeds))


def _as_uri(path: Path) -> str:
    return f"data:image/png;base64,{base64.b64encode(path.read_bytes()).decode()}"
