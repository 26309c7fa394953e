"""The tables of a path of all phases."""

import math
from collections.abc import Iterator, Sequence

from kurt2rt.experiments.load import Minute
from kurt2rt.experiments.phases.outcome import StageOutcome, TeachingOutcome
from kurt2rt.experiments.phases.steps import (
    ASKS,
    BLAME_BY_CHANCE,
    BRANCHES,
    CORRUPTED,
    CRITIC_ALONE,
    INTACT,
    JUDGED,
    LONG_RUN,
    PATH,
    PHASE_2,
    PHASE_3,
    PHASE_4,
    PHASE_5,
    REWARDS,
    SHUFFLED,
    TITLES,
    UNKNOWN_BAD,
    phases_of,
)
from kurt2rt.experiments.phases.study import Study
from kurt2rt.experiments.phases.summary import Paired, alike, collisions_of, paired, score_of, summarize, worlds_of
from kurt2rt.experiments.phases.verdict import interventions, robots_of_the_long_run, verdicts
from kurt2rt.experiments.report import label_of, quartiles
from kurt2rt.experiments.shown.intervals import rate_of
from kurt2rt.experiments.shown.sheet import Sheet

SUCCESS = (
    "Success is an exam without collision in which the robot is never stuck nor stopped by the guard, and makes at "
    "least the share of the teacher's own progress that the task asks. A robot that is stuck is set down elsewhere and "
    "drives on, so that collisions are those of the whole time. Exams pass over RLAs that are still withdrawn: their "
    "neighbours answer."
)
_PHASE_4 = "Phase 4 teaches the critic alone: what the robot drives by, and so its exams, are those of phase 3."
_PAIRED = (
    "The same robots from the same starts. Means, and the mean change with its 95 % interval, bootstrapped over the "
    "robots; where hardly anything happens it is too narrow. Better, worse, no longer clean: robots; what "
    "is not surely worse may be worse all the same."
)


def sheets(study: Study, reasons: Sequence[str]) -> Iterator[Sheet]:
    """All of them. `reasons` not to judge, if any."""
    yield asked_sheet(study, reasons)
    yield exam_sheet("Phase by phase", PATH, study, f"{SUCCESS} {_PHASE_4}")
    yield teachers_sheet(study)
    yield load_sheet("What the teacher had to do", (PHASE_2, PHASE_3, PHASE_4), study)
    yield critic_sheet(study)
    yield judged_sheet(study)
    yield exam_sheet(
        f"A set of phase 2 with {phases_of(study.programme.task).corrupted_share:.0%} wrong actions, and its repair",
        BRANCHES,
        study,
        "All branches begin with the same set of each robot. Asks only: the teacher answers, no more. Unknown is -1: "
        "he also blames what led into a situation that the robot does not know. By chance: he blames whatever drives "
        "now and then, and answers where the robot asks again. Critic alone: nobody is asked. "
        "Shuffled: the same appraisals with their opinions dealt out anew, trusted all the same. "
        + " ".join(words_of_controls(study)),
    )
    yield load_sheet("What that took", (ASKS, UNKNOWN_BAD, BLAME_BY_CHANCE, REWARDS), study)
    yield alone_sheet(study)
    yield paired_sheet(
        "What rewards add to answers alone", paired(study.stages[ASKS], study.stages[REWARDS]), f"{_PAIRED}"
    )
    yield paired_sheet(
        "What judging adds to blame by chance",
        paired(study.stages[BLAME_BY_CHANCE], study.stages[REWARDS]),
        _PAIRED,
    )
    yield paired_sheet(
        "What its opinions add to the shuffled critic",
        paired(study.stages[SHUFFLED], study.stages[CRITIC_ALONE]),
        _PAIRED,
    )
    yield paired_sheet(
        "An intact set, before and after phase 5", paired(study.stages[PHASE_2], study.stages[INTACT]), _PAIRED
    )
    yield paired_sheet(
        "The set of phase 2, and after all phases", paired(study.stages[PHASE_2], study.stages[PHASE_5]), _PAIRED
    )
    yield long_run_sheet(study)


def asked_sheet(study: Study, reasons: Sequence[str]) -> Sheet:
    """Each number that was asked for beside what came, and whether it is met, unless there are reasons not to judge."""
    found = list(verdicts(study))
    met = sum(each.met for each in found)
    note = f"{met} of {len(found)} numbers asked for are met." if found else "Of this task nothing is asked."
    return Sheet(
        "What was asked",
        ("what", "asked", "came", "verdict"),
        tuple((each.what, each.asked, each.came, "not judged" if reasons else each.word) for each in found),
        words=4,
        note=" ".join(["Not judged.", *reasons]) if reasons else note,
    )


def exam_sheet(title: str, stages: Sequence[str], study: Study, note: str) -> Sheet:
    """How robots drive at each stage, world by world."""
    rows = []
    for name in stages:
        rlas = quartiles([stage.rlas for stage in study.stages[name]])[1]
        withdrawn = f"{quartiles([stage.still_withdrawn for stage in study.stages[name]])[1]:g}"
        for place, world in enumerate(worlds_of(study.stages[name])):
            low, high = world.interval
            rate = world.collisions
            rows.append(
                (
                    TITLES[name] if place == 0 else "",
                    world.label,
                    f"{rlas:g}" if place == 0 else "",
                    f"{world.succeeded} of {world.robots}",
                    f"{low:.0%} to {high:.0%}",
                    f"{rate.value:.2f}",
                    f"{rate.low:.2f} to {rate.high:.2f}",
                    f"{world.stuck}",
                    f"{world.progress[1]:.1f} {world.unit}",
                    f"{world.progress[0]:.1f} to {world.progress[2]:.1f}",
                    f"{world.share_unknown:.1%}",
                    f"{world.changes_per_s:.2f}",
                    "" if world.distance_error_m is None else f"{world.distance_error_m:.3f}",
                    withdrawn if place == 0 else "",
                )
            )
    columns = (
        "stage",
        "world",
        "RLAs",
        "success",
        "95 %",
        "collisions in 10 min",
        "95 %",
        "stuck",
        "progress",
        "quartiles",
        "unknown",
        "changes/s",
        "distance error, m",
        "still withdrawn",
    )
    return Sheet(title, columns, tuple(rows), words=2, note=note)


def load_sheet(title: str, stages: Sequence[str], study: Study) -> Sheet:
    """What the teacher said, in all and in a minute."""
    rows = []
    for name in stages:
        taught = _taught(study.stages[name])
        said = [_all_of(each.load) for each in taught]
        minutes = taught[0].duration_s / 60.0
        cells = []
        for kind in Minute._fields:
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
    return Sheet(
        title,
        columns,
        tuple(rows),
        note="Medians of all robots; in brackets in a minute. Phases 1 and 2 are one lesson. Set down, shown, rescued "
        "and Go are the work of the hands: the robot carried elsewhere as planned, an action shown to the critic, "
        "carried away because it made no way, told to drive again after the guard had stopped it. Too late: rewards "
        "and appraisals that the robot refused.",
    )


def critic_sheet(study: Study) -> Sheet:
    """What the critic was taught, and how far it agrees."""
    rows = []
    for name in (PHASE_4, PHASE_5, CRITIC_ALONE, SHUFFLED, INTACT):
        stages = study.stages[name]
        taught = _taught(stages)
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
    return Sheet(
        "The critic",
        columns,
        tuple(rows),
        note="Agreement with the teacher's signals of phase 4, before they were learnt. Trusted: robots in which it "
        "ever was. Changes of actions and RLAs that it made, and those that were undone since its score fell.",
    )


def judged_sheet(study: Study) -> Sheet:
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
    return Sheet(
        "The critic, judged",
        ("share", "all robots together", "median robot", "quartiles"),
        tuple(rows),
        note="After phase 4, in a drive by the corrupted set of the branches in the world that is taught in: tick by "
        "tick beside the judge, and nothing is learnt. The critic has not seen these wrong actions.",
    )


def teachers_sheet(study: Study) -> Sheet:
    """The yardstick: how the teacher's own policy drives from the same starts."""
    rows = []
    for world in dict.fromkeys(exam.world for robot in study.teachers for exam in robot):
        drives = [exam for robot in study.teachers for exam in robot if exam.world == world]
        failed = [
            str(seed)
            for seed, robot in zip(study.programme.seeds, study.teachers, strict=True)
            if any(exam.world == world and not exam.succeeded for exam in robot)
        ]
        told, rate = summarize(drives), collisions_of(drives)
        rows.append(
            (
                told.label,
                f"{told.succeeded} of {told.robots}",
                f"{rate.value:.2f}",
                f"{told.stuck}",
                f"{told.progress[1]:.1f} {told.unit}",
                f"{told.progress[0]:.1f} to {told.progress[2]:.1f}",
                ", ".join(failed) or "none",
            )
        )
    columns = ("world", "without fault", "collisions in 10 min", "stuck", "progress", "quartiles", "seeds that failed")
    return Sheet(
        "How the teacher drives himself",
        columns,
        tuple(rows),
        note="By his policy from the starts of the exams: what progress is measured by. Where he failed himself, a "
        "robot that does as he does cannot be without fault.",
    )


def words_of_controls(study: Study) -> Iterator[str]:
    """Sentences on controls that say nothing, because what they are to show did not happen."""
    stages = study.stages
    robots = len(stages[ASKS])
    if not any(each.asks for each in _taught(stages[ASKS])):
        yield f"{TITLES[ASKS]}: no robot asked anything."
    never = sum(each.blame == 0 for each in _taught(stages[UNKNOWN_BAD]))
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


def alone_sheet(study: Study) -> Sheet:
    """What happened while nobody taught."""
    rows = []
    for name in (CRITIC_ALONE, SHUFFLED, INTACT, PHASE_5):
        taught = _taught(study.stages[name])
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
    return Sheet("While it learnt alone", columns, tuple(rows), note="In the world that is taught in.")


def paired_sheet(title: str, pairs: Sequence[Paired], note: str) -> Sheet:
    """The same robots at two stages."""
    rows = []
    for each in pairs:
        sure = "better" if each.surely_better else "worse" if each.surely_worse else ""
        change = each.difference
        rows.append(
            (
                label_of(each.world),
                each.measure.name,
                f"{each.before:.3f}",
                f"{each.after:.3f}",
                f"{change.value:+.3f}",
                f"{change.low:+.3f} to {change.high:+.3f}",
                f"{each.better}",
                f"{each.worse}",
                "" if each.measure.clean is None else f"{each.no_longer_clean}",
                sure,
            )
        )
    columns = ("world", "measure", "before", "after", "change", "95 %", "better", "worse", "no longer clean", "surely")
    return Sheet(title, columns, tuple(rows), words=2, note=note)


def long_run_sheet(study: Study) -> Sheet:
    """How often a person had to come."""
    taught = _taught(study.stages[LONG_RUN])
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
    return Sheet(
        "Interventions in the long run after phase 5",
        columns,
        (row,),
        words=0,
        note=f"{robots_of_the_long_run(study)}. All together, in the world that is taught in; the critic goes on.",
    )


def _taught(stages: Sequence[StageOutcome]) -> list[TeachingOutcome]:
    return [stage.teaching for stage in stages if stage.teaching is not None]


def _all_of(load: Sequence[Minute]) -> Minute:
    return Minute(*(sum(getattr(minute, kind) for minute in load) for kind in Minute._fields))
