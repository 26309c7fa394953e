"""One HTML file that holds everything: tables, figures, settings, and how it was made."""

import base64
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

import jinja2

from kurt2rt.durable import write_durably
from kurt2rt.experiments.paper.judging import reasons_not_to_judge
from kurt2rt.experiments.paper.made_of import versions
from kurt2rt.experiments.paper.pictures import Picture
from kurt2rt.experiments.paper.programme import ROBOTS
from kurt2rt.experiments.paper.settings_sheets import SUCCESS, exams_sheet, learning_sheet
from kurt2rt.experiments.paper.study import Study
from kurt2rt.experiments.paper.tables import sheets, unseen_sheet

_TEMPLATE = "report.html.j2"
_MADE_WITH = ("kurt2rt", "matplotlib", "jinja2")


def write_report(study: Study, pictures: Sequence[Picture], command: str, path: Path) -> None:
    """Write the report. `command`: what was typed, without what belongs to the machine alone. Raises OSError."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("kurt2rt.experiments.paper", ""),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    programme = study.programme
    html = environment.get_template(_TEMPLATE).render(
        study=study,
        reasons=list(reasons_not_to_judge(programme)),
        extent=programme.extent,
        seeds=_spans(programme.seeds),
        sheets=list(sheets(study)),
        unseen=[sheet for each in study.summaries if (sheet := unseen_sheet(each)).rows],
        robots=ROBOTS,
        settings=[learning_sheet(study), exams_sheet(study)],
        success=SUCCESS,
        pictures=[(each, _as_uri(each.path)) for each in pictures],
        command=command,
        versions=", ".join([versions(), *(f"{name} {version(name)}" for name in _MADE_WITH)]),
        source=programme.source,
    )
    write_durably(path, html)


def _as_uri(path: Path) -> str:
    return f"data:image/png;base64,{base64.b64encode(path.read_bytes()).decode()}"


def _spans(seeds: Sequence[int]) -> str:
    """Seeds as they are typed: 100-119, or 1,5,7."""
    first, last = seeds[0], seeds[-1]
    if len(seeds) > 1 and list(seeds) == list(range(first, last + 1)):
        return f"{first}-{last}"
    return ",".join(map(str, seeds))
