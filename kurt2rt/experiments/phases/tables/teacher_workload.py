"""What the teacher had to do."""

from collections.abc import Sequence

from kurt2rt.experiments.lockstep.report import quartiles
from kurt2rt.experiments.lockstep.teacher_workload import WorkloadMinute
from kurt2rt.experiments.phases.steps import TITLES
from kurt2rt.experiments.phases.study import PhasesStudy
from kurt2rt.experiments.phases.tables.taught import taught_of
from kurt2rt.experiments.study.table import Table


def load_sheet(title: str, stages: Sequence[str], study: PhasesStudy) -> Table:
    """What the teacher said, in all and in a minute."""
    rows = []
    for name in stages:
        taught = taught_of(study.stages[name])
        said = [_all_of(each.load) for each in taught]
        minutes = taught[0].duration_s / 60.0
        cells = []
        for kind in WorkloadMinute._fields:
            median = quartiles([getattr(each, kind) for each in said])[1]
            cells.append(f"{median:g} ({median / minutes:.1f})")
        rows.append(
            (
                TITLES[name],
                f"{taught[0].duration_s:g}",
                *cells,
                f"{quartiles([each.praise for each in taught])[1]:g}",
                f"{quartiles([each.blame for each in taught])[1]:g}",
                f"{quartiles([each.refused_signals for each in taught])[1]:g}",
                f"{quartiles([each.withdrawn for each in taught])[1]:g}",
            )
        )
    columns = (
        "step",
        "lasts, s",
        "answers",
        "corrections",
        "rewards",
        "appraisals",
        "set down",
        "shown",
        "rescued",
        "Go",
        "+1",
        "-1",
        "too late",
        "withdrawn",
    )
    return Table(
        title,
        columns,
        tuple(rows),
        note="Medians of all robots; in brackets in a minute. Phases 1 and 2 are one lesson. Set down, shown, rescued "
        "and Go are the work of the hands: the robot carried elsewhere as planned, an action shown to the critic, "
        "carried away because it made no way, told to drive again after the guard had stopped it. Too late: rewards "
        "and appraisals that the robot refused.",
    )


def _all_of(load: Sequence[WorkloadMinute]) -> WorkloadMinute:
    return WorkloadMinute(*(sum(getattr(minute, kind) for minute in load) for kind in WorkloadMinute._fields))
