"""One HTML file of a certificate: tables, pictures of the worst runs, and how it was made."""

from collections.abc import Sequence
from pathlib import Path

from kurt2rt.experiments.certify.plan import Certificate
from kurt2rt.experiments.study.figure import SavedFigure
from kurt2rt.experiments.study.html_report import write_page
from kurt2rt.experiments.study.table import Table


def write_report(
    certificate: Certificate, tables: Sequence[Table], pictures: Sequence[SavedFigure], command: str, path: Path
) -> None:
    """Write the report of a certificate as an HTML page to `path`. Raises OSError.

    `command`: typed words, without those that belong to the machine alone.
    """
    plan = certificate.plan
    write_page(
        path,
        "kurt2rt.experiments.certify",
        "report.html.j2",
        f"KURT2: certificate of a robot that was taught {plan.task.name}",
        pictures,
        tables=tables,
        first=plan.runs[0].number,
        last=plan.runs[-1].number,
        seconds=plan.task.exam.duration_s,
        command=command,
        source=plan.blocks[0].made_of.source,
    )
