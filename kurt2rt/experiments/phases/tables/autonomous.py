"""What happened while nobody taught."""

from kurt2rt.experiments.lockstep.report import quartiles
from kurt2rt.experiments.phases.steps import CRITIC_ALONE, INTACT, LONG_RUN, PHASE_5, SHUFFLED, TITLES
from kurt2rt.experiments.phases.study import PhasesStudy
from kurt2rt.experiments.phases.tables.taught import taught_of
from kurt2rt.experiments.phases.verdict import interventions, robots_of_the_long_run
from kurt2rt.experiments.study.intervals import rate_of
from kurt2rt.experiments.study.table import Table


def alone_sheet(study: PhasesStudy) -> Table:
    """What happened while nobody taught."""
    rows = []
    for name in (CRITIC_ALONE, SHUFFLED, INTACT, PHASE_5):
        taught = taught_of(study.stages[name])
        collisions = rate_of([each.collisions for each in taught], [each.duration_s / 600.0 for each in taught])
        rescues = rate_of([each.rescues for each in taught], [each.duration_s / 600.0 for each in taught])
        rows.append(
            (
                TITLES[name],
                f"{taught[0].duration_s:g}",
                f"{collisions.value:.2f}",
                f"{collisions.low:.2f} to {collisions.high:.2f}",
                f"{rescues.value:.2f}",
                f"{quartiles([each.share_unknown for each in taught])[1]:.1%}",
            )
        )
    columns = ("step", "lasts, s", "collisions in 10 min", "95 %", "rescues in 10 min", "unknown")
    return Table("While it learnt alone", columns, tuple(rows), note="In the world that is taught in.")


def long_run_sheet(study: PhasesStudy) -> Table:
    """How often a person had to come."""
    taught = taught_of(study.stages[LONG_RUN])
    rate = interventions(study)
    row = (
        f"{sum(each.duration_s for each in taught) / 3600.0:.1f}",
        f"{sum(each.collisions for each in taught)}",
        f"{sum(each.rescues - each.unknown_rescues for each in taught)}",
        f"{sum(each.unknown_rescues for each in taught)}",
        f"{sum(each.alarms for each in taught)}",
        f"{rate.value:.2f}",
        f"{rate.low:.2f} to {rate.high:.2f}",
    )
    columns = ("hours", "collisions", "stuck", "unknown for long", "stopped", "an hour", "95 %")
    return Table(
        "Interventions in the long run after phase 5",
        columns,
        (row,),
        words=0,
        note=f"{robots_of_the_long_run(study)}. All together, in the world that is taught in; the critic goes on.",
    )
