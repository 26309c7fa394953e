"""One HTML file that holds everything: tables, figures, settings, and how it was made."""

from collections.abc import Sequence
from pathlib import Path

from kurt2rt.experiments.paper.judging import reasons_not_to_judge
from kurt2rt.experiments.paper.settings_tables import SUCCESS, exams_sheet, learning_sheet
from kurt2rt.experiments.paper.study import PaperStudy
from kurt2rt.experiments.paper.tables import sheets, unseen_sheet
from kurt2rt.experiments.study.eligibility import ROBOTS
from kurt2rt.experiments.study.figure import SavedFigure
from kurt2rt.experiments.study.html_report import spans, write_page

_TITLE = "KURT2: the paper's basic-level tasks, taught and examined"


def write_report(study: PaperStudy, pictures: Sequence[SavedFigure], command: str, path: Path) -> None:
    """Write the report. `command`: what was typed, without what belongs to the machine alone. Raises OSError."""
    programme = study.programme
    write_page(
        path,
        "kurt2rt.experiments.paper",
        "report.html.j2",
        _TITLE,
        pictures,
        study=study,
        reasons=list(reasons_not_to_judge(programme)),
        extent=programme.extent,
        seeds=spans(programme.seeds),
        sheets=list(sheets(study)),
        unseen=[sheet for each in study.summaries if (sheet := unseen_sheet(each)).rows],
        robots=ROBOTS,
        settings=[learning_sheet(study), exams_sheet(study)],
        success=SUCCESS,
        command=command,
        source=programme.source,
    )
