"""One HTML file of a league."""

from collections.abc import Sequence
from pathlib import Path

from kurt2rt.experiments.rivals.plan import League
from kurt2rt.experiments.rivals.tables import tuning_text
from kurt2rt.experiments.study.figure import SavedFigure
from kurt2rt.experiments.study.html_report import spans, write_page
from kurt2rt.experiments.study.table import Table


def write_report(
    league: League,
    tables: Sequence[Table],
    picture: SavedFigure,
    not_judged: Sequence[str],
    command: str,
    path: Path,
) -> None:
    """Write the report of a league as an HTML page to `path`. Raises OSError.

    `not_judged`: reasons against judging the numbers. `command`: typed words that decide the numbers.
    """
    plan = league.plan
    write_page(
        path,
        "kurt2rt.experiments.rivals",
        "report.html.j2",
        "KURT2: learners taught by the same teacher",
        [picture],
        tables=tables,
        not_judged=not_judged,
        not_tuned=tuning_text(league),
        teachers=sorted({task.teaching.profile.name for task in plan.tasks}),
        seeds=spans(plan.seeds),
        by_holds=any(entry.rival.is_held for entry in plan.entries),
        by_rewards=any(entry.rival.is_rewarded for entry in plan.entries),
        by_trials=any(entry.rival.is_agent for entry in plan.entries),
        command=command,
        source=plan.policy_jobs[0].made_of.source,
    )
