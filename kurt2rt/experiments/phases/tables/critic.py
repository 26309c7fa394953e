"""What the critic was taught, and what it says."""

import math

from kurt2rt.experiments.lockstep.report import quartiles
from kurt2rt.experiments.phases.steps import CRITIC_ALONE, INTACT, JUDGED, PHASE_4, PHASE_5, SHUFFLED, TITLES
from kurt2rt.experiments.phases.study import PhasesStudy
from kurt2rt.experiments.phases.summary import score_of
from kurt2rt.experiments.phases.tables.taught import taught_of
from kurt2rt.experiments.study.table import Table


def critic_sheet(study: PhasesStudy) -> Table:
    """What the critic was taught, and how far it agrees."""
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
                # Elsewhere nobody says what it could agree with: what there is was heard in phase 4, or made up.
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


def judged_sheet(study: PhasesStudy) -> Table:
    """What the critic says where it learns nothing, beside what the judge thinks."""
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
        "tick beside the judge, and nothing is learnt. The critic has not seen these wrong actions.",
    )
