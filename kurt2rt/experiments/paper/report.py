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
from kurt2rt.experiments.paper.sheet import Sheet
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
        settings=settings_sheet(study),
        pictures=[(each, _as_uri(each.path)) for each in pictures],
        command=command,
        versions=", ".join([versions(), *(f"{name} {version(name)}" for name in _MADE_WITH)]),
        source=programme.source,
    )
    write_durably(path, html)


def settings_sheet(study: Study) -> Sheet:
    """How each task was taught."""
    rows = []
    for each in study.summaries:
        learning, teaching, teacher = each.task.learning, each.task.teaching, each.task.teaching.teacher
        again = f"every {teaching.reposition_every_s:g} s, {teaching.reposition_to}".replace("_", " ")
        rows.append(
            (
                each.label,
                each.reading,
                f"{learning.radius:g}",
                f"{learning.past_weight:g}",
                f"{learning.insert_beyond_share:g}",
                f"{learning.minimum_action_s:g}",
                teaching.world,
                f"{teaching.supervised_s:g} + {teaching.corrections_s:g}",
                f"{teacher.reaction_s:g}",
                f"{teacher.patience_s:g}",
                f"{teacher.error_rate:.0%}",
                f"after {teacher.delete_after} replacements" if teacher.delete_after else "never",
                again if teaching.reposition_every_s else "no",
            )
        )
    columns = (
        "task",
        "reading",
        "R",
        "weight of the averages",
        "insert beyond, share of R",
        "an action lasts at least, s",
        "taught in",
        "phases 1 + 2, s",
        "reaction, s",
        "patience, s",
        "wrong answers",
        "deletes",
        "re-positions",
    )
    return Sheet("Settings of learning and of the scripted teacher", columns, tuple(rows), words=2)


def _as_uri(path: Path) -> str:
    return f"data:image/png;base64,{base64.b64encode(path.read_bytes()).decode()}"


def _spans(seeds: Sequence[int]) -> str:
    """Seeds as they are typed: 100-119, or 1,5,7."""
    first, last = seeds[0], seeds[-1]
    if len(seeds) > 1 and list(seeds) == list(range(first, last + 1)):
        return f"{first}-{last}"
    return ",".join(map(str, seeds))
