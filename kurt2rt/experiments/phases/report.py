"""One HTML file that holds everything: tables, figures, settings, and how it was made."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from kurt2rt.experiments.phases.plan import PhasesPlan
from kurt2rt.experiments.phases.summary import PhasesStudy
from kurt2rt.experiments.phases.tables import all_tables, settings_table
from kurt2rt.experiments.study.eligibility import reasons_against_judging
from kurt2rt.experiments.study.figure import SavedFigure
from kurt2rt.experiments.study.html_report import spans, write_page
from kurt2rt.experiments.study.provenance import source_hash


def reasons_not_to_judge(plan: PhasesPlan) -> Iterator[str]:
    """Yield why the report compares no result with its target; none for a whole study with enough new robots."""
    if plan.quick:
        yield "A part only: it says that everything works, and nothing about the phases."
    yield from reasons_against_judging(plan.seeds)


def write_report(study: PhasesStudy, pictures: Sequence[SavedFigure], command: str, path: Path) -> None:
    """Write the report as an HTML page.

    `command`: typed words, without those that belong to the machine alone. Raises OSError, and SettingsError if the
    task has no section on phases.
    """
    plan = study.plan
    reasons = list(reasons_not_to_judge(plan))
    write_page(
        path,
        "kurt2rt.experiments.phases",
        "report.html.j2",
        f"KURT2: {plan.task.name.replace('_', ' ')}, phases 1 to 5",
        pictures,
        reasons=reasons,
        seeds=spans(plan.seeds),
        tables=list(all_tables(study, reasons)),
        settings=settings_table(plan.task),
        command=command,
        source=source_hash(),
    )
