"""Tables of the teaching: workload, critic and autonomous phase."""

import math
from collections.abc import Iterator, Sequence

from kurt2rt.experiments.lockstep.report import quartiles
from kurt2rt.experiments.lockstep.teacher_workload import WorkloadMinute
from kurt2rt.experiments.phases.outcome import StageOutcome, TeachingOutcome
from kurt2rt.experiments.phases.steps import (
    ASKS,
    BLAME_BY_CHANCE,
    CORRUPTED,
    CRITIC_ALONE,
    INTACT,
    JUDGED,
    LONG_RUN,
    PHASE_4,
    PHASE_5,
    REWARDS,
    SHUFFLED,
    TITLES,
    UNKNOWN_BAD,
)
from kurt2rt.experiments.phases.summary import PhasesStudy, alike, score_of
from kurt2rt.experiments.phases.verdicts import interventions, robots_of_the_long_run
from kurt2rt.experiments.study.intervals import rate_of
from kurt2rt.experiments.study.table import Table


def taught_of(stages: Sequence[StageOutcome]) -> list[TeachingOutcome]:
    """Return the training runs of the stages that had one."""
    return [stage.teaching for stage in stages if stage.teaching is not None]


def workload_table(title: str, stages: Sequence[str], study: PhasesStudy) -> Table:
    """Return the table of the teacher's commands at these stages, by name: in total and for each minute."""
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
        "stops to look back",
        "own presses undone",
        "demonstrated",
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


def critic_table(study: PhasesStudy) -> Table:
    """Return the table of the critic: appraisals and agreement."""
    rows = []
    for name in (PHASE_4, PHASE_5, CRITIC_ALONE, SHUFFLED, INTACT):
        stages = study.stages[name]
        taught = taught_of(stages)
        ends = [each.agreement[-1] for each in taught if each.agreement]
        shares = [share for share in ends if share is not None]
        agreement = quartiles(shares) if shares else None
        rows.append(
            (
                TITLES[name],
                f"{quartiles([stage.appraisals for stage in stages])[1]:g}",
                # Other steps have no teacher to agree with: their agreement is that of phase 4, or made up.
                "" if name != PHASE_4 else "too little heard" if agreement is None else f"{agreement[1]:.2f}",
                "" if name != PHASE_4 or agreement is None else f"{agreement[0]:.2f} to {agreement[2]:.2f}",
                f"{sum(each.share_trusted > 0 for each in taught)} of {len(taught)}",
                f"{quartiles([each.critics_changes for each in taught])[1]:g}",
                f"{quartiles([each.rolled_back for each in taught])[1]:g}",
            )
        )
    columns = ("step", "appraisal RLAs", "agreement at its end", "quartiles", "trusted", "changes", "undone")
    return Table(
        "The critic",
        columns,
        tuple(rows),
        note="Agreement with the teacher's signals of phase 4, before they were learnt. Trusted: robots in which it "
        "ever was. Changes of actions and RLAs that it made, and those that were undone since its score fell.",
    )


def judged_table(study: PhasesStudy) -> Table:
    """Return the table of the opinions of critic and judge."""
    robots = [stage.judgements for stage in study.stages[JUDGED]]
    together = score_of([each for robot in robots for each in robot])
    scores = [score_of(each) for each in robots]
    rows = []
    for words, name in (
        ("of what it calls bad is bad", "precision"),
        ("of what is bad it calls so", "recall"),
        ("agreement, mean of bad and good", "agreement"),
        ("does not know", "silent"),
    ):
        shares = [share for share in (getattr(each, name) for each in scores) if share is not None]
        low, median, high = quartiles(shares) if shares else (math.nan,) * 3
        value: float | None = getattr(together, name)
        told = ("nothing", "", "") if value is None else (f"{value:.2f}", f"{median:.2f}", f"{low:.2f} to {high:.2f}")
        rows.append((words, *told))
    return Table(
        "The critic, judged",
        ("share", "all robots together", "median robot", "quartiles"),
        tuple(rows),
        note="After phase 4, in a drive by the corrupted set of the branches in the world that is taught in: tick by "
        "tick with the judge, and nothing is learnt. The critic has not seen these wrong actions.",
    )


def autonomous_table(study: PhasesStudy) -> Table:
    """Return the table of the drives without a teacher."""
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


def long_run_table(study: PhasesStudy) -> Table:
    """Return the table of interventions in the long run."""
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


def words_of_controls(study: PhasesStudy) -> Iterator[str]:
    """Yield sentences on controls without effect."""
    stages = study.stages
    robots = len(stages[ASKS])
    if not any(each.asks for each in taught_of(stages[ASKS])):
        yield f"{TITLES[ASKS]}: no robot asked anything."
    never = sum(each.blame == 0 for each in taught_of(stages[UNKNOWN_BAD]))
    if never:
        yield f"{TITLES[UNKNOWN_BAD]}: {never} of {robots} robots never met the unknown, so no -1 came."
    for one, other in (
        (ASKS, CORRUPTED),
        (UNKNOWN_BAD, ASKS),
        (BLAME_BY_CHANCE, ASKS),
        (REWARDS, ASKS),
        (CRITIC_ALONE, CORRUPTED),
        (SHUFFLED, CORRUPTED),
    ):
        same = alike(stages[one], stages[other])
        if same:
            yield f"{TITLES[one]}: {same} of {robots} robots drive exactly as in '{TITLES[other]}'."
