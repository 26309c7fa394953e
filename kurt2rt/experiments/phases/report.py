"""One HTML file that holds everything: tables, figures, settings, and how it was made."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from kurt2rt.experiments.phases.plan import PhasesPlan
from kurt2rt.experiments.phases.settings_table import settings_sheet
from kurt2rt.experiments.phases.study import PhasesStudy
from kurt2rt.experiments.phases.table_rows import sheets
from kurt2rt.experiments.study.eligibility import reasons_of_robots
from kurt2rt.experiments.study.figure import SavedFigure
from kurt2rt.experiments.study.html_report import spans, write_page


def reasons_not_to_judge(programme: PhasesPlan) -> Iterator[str]:
    """Sentences; none where everything was done, by enough robots that nobody has seen."""
    if programme.quick:
        yield "A part only: it says that everything works, and nothing about the phases."
    yield from reasons_of_robots(programme.seeds)


def write_report(study: PhasesStudy, pictures: Sequence[SavedFigure], command: str, path: Path) -> None:
    """Write the report. `command`: what was typed, without what belongs to the machine alone. Raises OSError."""
    programme = study.programme
    reasons = list(reasons_not_to_judge(programme))
    write_page(
        path,
        "kurt2rt.experiments.phases",
        "report.html.j2",
        f"KURT2: {programme.task.name.replace('_', ' ')}, phases 1 to 5",
        pictures,
        reasons=reasons,
        seeds=spans(programme.seeds),
        sheets=list(sheets(study, reasons)),
        settings=settings_sheet(programme.task),
        command=command,
        source=programme.source,
    )
