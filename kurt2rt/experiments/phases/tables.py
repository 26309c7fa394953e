"""Tables of the phases study with its verdicts, and its report."""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from behaviors.metrics.task_metric import DISTANCE_ERROR
from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.phase_settings import AskedShare
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.drive_row import DriveRow, label_of
from kurt2rt.experiments.lockstep.teacher_workload import WorkloadMinute
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
from kurt2rt.experiments.phases.study import JobOutcome, Judgement, PhasesTask, StageOutcome, TeachingOutcome
from kurt2rt.experiments.study.figures import SavedFigure
from kurt2rt.experiments.study.intervals import (
    TEN_MIN_S,
    Rate,
    collisions_in_10_min,
    difference_of,
    fall_of,
    quartiles,
    rate_of,
)
from kurt2rt.experiments.study.report import Section, spans, write_report
from kurt2rt.experiments.study.study_plan import StudyPlan
from kurt2rt.experiments.study.table import Table, median, of_text, share_text, table_of, to_text
from kurt2rt.experiments.study.targets import Verdict, needed_of, reasons_against_judging, targets_table

_HOUR_S = 3600.0
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


@dataclass(frozen=True, slots=True)
class PhasesStudy:
    """Results of `kurt2rt study phases` by step and robot, from which tables and figures are made."""

    plan: StudyPlan[PhasesTask]
    stages: dict[str, tuple[StageOutcome, ...]]
    """Outcomes by the name of the step, in the order of the seeds."""
    teachers: tuple[tuple[DriveRow, ...], ...]
    """Drives of the teacher's own policy, per seed one in each world."""

    def taught(self, name: str) -> list[TeachingOutcome]:
        """Return the training runs of a step, of the robots that had one."""
        return [stage.teaching for stage in self.stages[name] if stage.teaching is not None]


def read_study(plan: StudyPlan[PhasesTask]) -> PhasesStudy:
    """Read the results of all jobs of the plan. Raises StudyError if a result is missing or damaged."""
    outcomes = [job.results.read(job, JobOutcome) for job in plan.jobs]
    stages: dict[str, list[StageOutcome]] = {}
    for stage in (stage for outcome in outcomes for stage in outcome.stages):
        stages.setdefault(stage.name, []).append(stage)
    teachers = tuple(outcome.teachers for outcome in outcomes if outcome.teachers)
    return PhasesStudy(plan, {name: tuple(each) for name, each in stages.items()}, teachers)


def reasons_not_to_judge(plan: StudyPlan[PhasesTask]) -> Iterator[str]:
    """Yield why the report compares no result with its target; none for a whole study with enough new robots."""
    if plan.about.quick:
        yield "A part only: it says that everything works, and nothing about the phases."
    yield from reasons_against_judging(plan.seeds)


def by_world(robots: Iterable[Iterable[DriveRow]]) -> dict[str, list[DriveRow]]:
    """Return the drives of all robots in each world."""
    drives = [drive for robot in robots for drive in robot]
    return {world: [each for each in drives if each.world == world] for world in dict.fromkeys(d.world for d in drives)}


def drives_of(stages: Sequence[StageOutcome]) -> dict[str, list[DriveRow]]:
    """Return the exams of one stage of all robots in each world."""
    return by_world(stage.exams for stage in stages)


def passed_of(drives: Sequence[DriveRow]) -> int:
    """Return the number of drives that passed."""
    return sum(each.passed for each in drives)


@dataclass(frozen=True, slots=True)
class CriticScore:
    """Agreement of critic and judge, as ratios; None without ticks."""

    precision: float | None
    """Ratio of ticks called bad that are bad."""
    recall: float | None
    """Ratio of bad ticks that are called bad."""
    agreement: float | None
    """Mean over bad and good ones of the share that it calls so."""
    silent: float | None
    """Share of ticks of which it does not know anything."""


def score_of(judgements: Sequence[Judgement]) -> CriticScore:
    """Return the agreement of critic and judge, pooled over all ticks of all judgements."""

    def share(part: Callable[[Judgement], bool], whole: Callable[[Judgement], bool]) -> float | None:
        ticks = sum(each.ticks for each in judgements if whole(each))
        return sum(each.ticks for each in judgements if part(each) and whole(each)) / ticks if ticks else None

    rights = [share(lambda each: each.said == value, lambda each: each.judged == value) for value in (-1, 1)]  # noqa: B023
    known = [right for right in rights if right is not None]
    return CriticScore(
        precision=share(lambda each: each.judged == -1, lambda each: each.said == -1),
        recall=rights[0],
        agreement=sum(known) / len(known) if known else None,
        silent=share(lambda each: each.said is None, lambda _: True),
    )


def alike(one: Sequence[StageOutcome], other: Sequence[StageOutcome]) -> int:
    """Return the number of robots whose exams have equal outcomes at two stages.

    Both sequences hold one stage per robot, in the same order. Raises ValueError if their lengths differ.
    """
    return sum(a.exams == b.exams for a, b in zip(one, other, strict=True))


@dataclass(frozen=True, slots=True)
class Measure:
    """Something of an exam that may become better or worse."""

    name: str
    of: Callable[[DriveRow], float | None]
    better: int
    """+1: more is better, -1: less is."""
    clean: float | None = None
    """The value of an exam without fault, where such are counted; None where they are measured."""


MEASURES = (
    Measure("success", lambda exam: float(exam.passed), +1, clean=1.0),
    Measure("collisions in 10 min", lambda exam: exam.collisions * TEN_MIN_S / exam.duration_s, -1, clean=0.0),
    Measure("progress", lambda exam: exam.progress, +1),
    Measure(DISTANCE_ERROR, lambda exam: exam.findings.get(DISTANCE_ERROR), -1),
    Measure("action changes per s", lambda exam: exam.action_changes_per_s, -1),
)


@dataclass(frozen=True, slots=True)
class Paired:
    """The same robots at two stages, in one world, by one measure."""

    world: str
    measure: Measure
    before: float
    """Mean."""
    after: float
    difference: Rate
    better: int
    """Robots."""
    worse: int
    no_longer_clean: int
    """Robots that were clean before and are not after; 0 of what is measured."""

    @property
    def worst_change(self) -> float:
        """Bad end of the interval, as a share of the mean before; above 0: worse."""
        worst = -self.difference.low if self.measure.better > 0 else self.difference.high
        return worst / abs(self.before) if self.before else math.copysign(math.inf, worst) if worst else 0.0

    def not_worse(self, margin: float) -> bool:
        """Return whether no robot stopped being clean, or the measure is not worse by this ratio."""
        return not self.no_longer_clean if self.measure.clean is not None else self.worst_change <= margin

    @property
    def surely_worse(self) -> bool:
        """True if the whole interval is worse."""
        return self.difference.high < 0 if self.measure.better > 0 else self.difference.low > 0

    @property
    def surely_better(self) -> bool:
        """True if the whole interval is better."""
        return self.difference.low > 0 if self.measure.better > 0 else self.difference.high < 0


def paired(before: Sequence[StageOutcome], after: Sequence[StageOutcome]) -> tuple[Paired, ...]:
    """Return the change of each measure from one stage to another of the same robots, world by world.

    Both sequences hold one stage per robot, in the same order, and each stage an exam in each world. A measure that
    no robot has at both stages is left out. Raises ValueError if the lengths differ.
    """
    worlds, then = drives_of(before), drives_of(after)
    found = []
    for world, exams in then.items():
        for measure in MEASURES:
            values = [(measure.of(one), measure.of(other)) for one, other in zip(worlds[world], exams, strict=True)]
            known = [(one, other) for one, other in values if one is not None and other is not None]
            if known:
                found.append(_paired(world, measure, known))
    return tuple(found)


def _paired(world: str, measure: Measure, values: Sequence[tuple[float, float]]) -> Paired:
    changes = [other - one for one, other in values]
    return Paired(
        world=world,
        measure=measure,
        before=sum(one for one, _ in values) / len(values),
        after=sum(other for _, other in values) / len(values),
        difference=difference_of(changes),
        better=sum(change * measure.better > 0 for change in changes),
        worse=sum(change * measure.better < 0 for change in changes),
        no_longer_clean=sum(one == measure.clean != other for one, other in values),
    )


def verdicts(study: PhasesStudy) -> Iterator[Verdict]:
    """Yield the verdict on each target of the task.

    Raises config.settings.SettingsError if the task has no section on phases.
    """
    phases = phases_of(study.plan.about.task)
    asked = phases.asked
    corrupted, alone = study.stages[CORRUPTED], study.stages[CRITIC_ALONE]
    yield from _repaired("repaired by phase 3", study.stages[REWARDS], asked.repaired_by_rewards)
    if asked.repaired_by_rewards and phases.signals.most_blame:
        most, limit = max(each.negative_rewards for each in study.taught(REWARDS)), phases.signals.most_blame
        yield Verdict("blame in phase 3, most of all robots", f"at most {limit}", str(most), most <= limit)
    yield from _repaired("repaired by the critic alone", alone, asked.repaired_by_critic)
    if asked.collisions_fall_by:
        both = [[robot.exams for robot in stages] for stages in (corrupted, alone)]
        before, after = (collisions_in_10_min([exam for exams in robots for exam in exams]).value for robots in both)
        fall = fall_of(*([collisions_in_10_min(exams).value for exams in robots] for robots in both))
        yield Verdict(
            "collisions fall by the critic alone",
            f"by {asked.collisions_fall_by:.0%}",
            f"by {fall.value:.0%} ({to_text(fall[1:], '.0%')}), {before:.2f} to {after:.2f} in 10 min",
            fall.value >= asked.collisions_fall_by,
        )
    if asked.intact_not_worse:
        for each in paired(study.stages[PHASE_2], study.stages[INTACT]):
            yield _not_worse(each, asked.not_worse_margin)
    if asked.interventions_below_per_hour:
        rate, most_h = interventions(study), asked.interventions_below_per_hour
        came = f"{rate.value:.2f} ({to_text(rate[1:], '.2f')}); {robots_of_the_long_run(study)}"
        yield Verdict("interventions an hour after phase 5", f"below {most_h:g}", came, rate.value < most_h)


def interventions(study: PhasesStudy) -> Rate:
    """Return the interventions in an hour, of all robots in the long run."""
    taught = study.taught(LONG_RUN)
    return rate_of([each.interventions for each in taught], [each.teaching_s / _HOUR_S for each in taught])


def robots_of_the_long_run(study: PhasesStudy) -> str:
    """Return the number of robots, their hours, and the most interventions of one robot."""
    taught = study.taught(LONG_RUN)
    minutes = " or ".join(f"{each:g}" for each in sorted({each.teaching_s / 60.0 for each in taught}))
    return f"{len(taught)} robots of {minutes} min each, of which the worst had {max(t.interventions for t in taught)}"


def _repaired(what: str, stages: tuple[StageOutcome, ...], asked: tuple[AskedShare, ...]) -> Iterator[Verdict]:
    share_in = {each.world: each.share for each in asked}
    for world, drives in drives_of(stages).items():
        if world in share_in:
            needed, passed = needed_of(share_in[world], len(drives)), passed_of(drives)
            at_least = f"at least {of_text(needed, len(drives))}"
            yield Verdict(f"{what}, {label_of(world)}", at_least, of_text(passed, len(drives)), passed >= needed)


def _not_worse(pair: Paired, margin: float) -> Verdict:
    what = f"an intact set in phase 5, {label_of(pair.world)}: {pair.measure.name}"
    means = f"{pair.before:.3f} -> {pair.after:.3f}"
    if pair.measure.clean is not None:
        asked, came = "no robot that was clean is not after", f"robots no longer clean: {pair.no_longer_clean}"
        return Verdict(what, asked, f"{means}; {came}", pair.not_worse(margin))
    direction = "worse" if pair.worst_change > 0 else "better"
    asked, came = f"worse by at most {margin:.0%}, at the bad end of 95 %", f"{abs(pair.worst_change):.1%} {direction}"
    return Verdict(what, asked, f"{means}, at worst {came}", pair.not_worse(margin))


def phases_targets_table(study: PhasesStudy, not_judged_because: Sequence[str]) -> Table:
    """Return the table of all targets with their results; with reasons against judging, none is judged.

    Raises config.settings.SettingsError if the task has no section on phases.
    """
    found = [((), each) for each in verdicts(study)]
    return targets_table(found, not_judged_because, note_without_targets="Of this task nothing is asked.")


def all_tables(study: PhasesStudy, reasons: Sequence[str]) -> Iterator[Table]:
    """Yield all tables. `reasons`: those against judging.

    Raises config.settings.SettingsError if the task has no section on phases.
    """
    yield phases_targets_table(study, reasons)
    taught_by = f"Taught by the scripted teacher {study.plan.about.task.teaching.profile.name}."
    yield exam_table("Phase by phase", PATH, study, f"{taught_by} {SUCCESS} {_PHASE_4}")
    yield teachers_table(study)
    yield workload_table("What the teacher had to do", (PHASE_2, PHASE_3, PHASE_4), study)
    yield critic_table(study)
    yield judged_table(study)
    yield exam_table(
        f"A set of phase 2 with {phases_of(study.plan.about.task).corrupted_share:.0%} wrong actions, and its repair",
        BRANCHES,
        study,
        "All branches begin with the same set of each robot. Asks only: the teacher answers, no more. Unknown is -1: "
        "he also blames what led into a situation that the robot does not know. By chance: he blames whatever drives "
        "now and then, and answers where the robot asks again. Critic alone: there is no teacher to ask. "
        "Shuffled: the same appraisals with their opinions shuffled, trusted all the same. "
        + " ".join(words_of_controls(study)),
    )
    yield workload_table("What that took", (ASKS, UNKNOWN_BAD, BLAME_BY_CHANCE, REWARDS), study)
    yield autonomous_table(study)
    for title, before, after in (
        ("What rewards add to answers alone", ASKS, REWARDS),
        ("What judging adds to blame by chance", BLAME_BY_CHANCE, REWARDS),
        ("What its opinions add to the shuffled critic", SHUFFLED, CRITIC_ALONE),
        ("An intact set, before and after phase 5", PHASE_2, INTACT),
        ("The set of phase 2, and after all phases", PHASE_2, PHASE_5),
    ):
        yield paired_table(title, paired(study.stages[before], study.stages[after]))
    yield long_run_table(study)


class _Exams(NamedTuple):
    """Row of a table: exams of one stage in one world."""

    stage: str
    world: str
    drives: Sequence[DriveRow]
    is_first: bool
    """True for the first world of the stage, whose row tells what is the same in all worlds."""


def exam_table(title: str, stages: Sequence[str], study: PhasesStudy, note: str) -> Table:
    """Return the table of the exams at these stages, by name, world by world; `note` stands below it."""
    rows = [
        _Exams(name, world, drives, place == 0)
        for name in stages
        for place, (world, drives) in enumerate(drives_of(study.stages[name]).items())
    ]

    def of_stage(count: Callable[[StageOutcome], int]) -> Callable[[_Exams], str]:
        return lambda each: f"{median(map(count, study.stages[each.stage])):g}" if each.is_first else ""

    def error(each: _Exams) -> str:
        errors = [drive.findings[DISTANCE_ERROR] for drive in each.drives if DISTANCE_ERROR in drive.findings]
        return f"{median(errors):.3f}" if errors else ""

    def progress(drives: Sequence[DriveRow]) -> tuple[float, float, float]:
        return quartiles([drive.progress for drive in drives])

    return table_of(
        title,
        rows,
        ("stage", lambda each: TITLES[each.stage] if each.is_first else ""),
        ("world", lambda each: label_of(each.world)),
        ("RLAs", of_stage(lambda stage: stage.rlas)),
        ("success", lambda each: of_text(passed_of(each.drives), len(each.drives))),
        ("95 %", lambda each: share_text(passed_of(each.drives), len(each.drives))),
        *_collision_columns(lambda each: collisions_in_10_min(each.drives)),
        ("stuck", lambda each: sum(drive.ended_early for drive in each.drives)),
        ("progress", lambda each: f"{progress(each.drives)[1]:.1f} {each.drives[0].unit}"),
        ("quartiles", lambda each: to_text(progress(each.drives)[::2], ".1f")),
        ("unknown", lambda each: f"{median(drive.share_unknown for drive in each.drives):.1%}"),
        ("changes/s", lambda each: f"{median(drive.action_changes_per_s for drive in each.drives):.2f}"),
        ("distance error, m", error),
        ("still withdrawn", of_stage(lambda stage: stage.still_withdrawn)),
        words=2,
        note=note,
    )


def _collision_columns(rate: Callable[[Any], Rate]) -> tuple[tuple[str, Callable[[Any], str]], ...]:
    return (
        ("collisions in 10 min", lambda each: f"{rate(each).value:.2f}"),
        ("95 %", lambda each: to_text(rate(each)[1:], ".2f")),
    )


def paired_table(title: str, pairs: Sequence[Paired]) -> Table:
    """Return the table of the changes of the same robots between two stages."""
    return table_of(
        title,
        pairs,
        ("world", lambda each: label_of(each.world)),
        ("measure", lambda each: each.measure.name),
        ("before", lambda each: f"{each.before:.3f}"),
        ("after", lambda each: f"{each.after:.3f}"),
        ("change", lambda each: f"{each.difference.value:+.3f}"),
        ("95 %", lambda each: to_text(each.difference[1:], "+.3f")),
        ("better", lambda each: each.better),
        ("worse", lambda each: each.worse),
        ("no longer clean", lambda each: "" if each.measure.clean is None else each.no_longer_clean),
        ("surely", lambda each: "better" if each.surely_better else "worse" if each.surely_worse else ""),
        words=2,
        note=_PAIRED,
    )


def teachers_table(study: PhasesStudy) -> Table:
    """Return the table of the drives of the teacher's own policy from the same starts."""

    def failed(drives: Sequence[DriveRow]) -> str:
        seeds = zip(study.plan.seeds, drives, strict=True)
        return ", ".join(str(seed) for seed, drive in seeds if not drive.passed) or "none"

    return table_of(
        "How the teacher drives himself",
        by_world(study.teachers).values(),
        ("world", lambda drives: label_of(drives[0].world)),
        ("without fault", lambda drives: of_text(passed_of(drives), len(drives))),
        ("collisions in 10 min", lambda drives: f"{collisions_in_10_min(drives).value:.2f}"),
        ("stuck", lambda drives: sum(drive.ended_early for drive in drives)),
        ("progress", lambda drives: f"{median(drive.progress for drive in drives):.1f} {drives[0].unit}"),
        ("quartiles", lambda drives: to_text(quartiles([drive.progress for drive in drives])[::2], ".1f")),
        ("seeds that failed", failed),
        note="By his policy from the starts of the exams: what progress is measured by. Where he failed himself, a "
        "robot that does as he does cannot be without fault.",
    )


_SAID = {
    "lessons": "answers",
    "corrections": "corrections",
    "rewards": "rewards",
    "appraisals": "appraisals",
    "set_down": "set down",
    "shown": "shown",
    "rescued": "rescued",
    "go": "Go",
    "stops": "stops to look back",
    "undone": "own presses undone",
}
"""Headings of what a teacher does, by the field of WorkloadMinute."""


def workload_table(title: str, steps: Sequence[str], study: PhasesStudy) -> Table:
    """Return the table of the teacher's commands at these steps, by name: in total and for each minute."""

    def said(kind: str) -> Callable[[str], str]:
        def cell(name: str) -> str:
            taught = study.taught(name)
            middle = median(sum(getattr(minute, kind) for minute in each.workload) for each in taught)
            return f"{middle:g} ({middle / (taught[0].teaching_s / 60.0):.1f})"

        return cell

    def counted(count: Callable[[TeachingOutcome], int]) -> Callable[[str], str]:
        return lambda name: f"{median(map(count, study.taught(name))):g}"

    return table_of(
        title,
        steps,
        ("step", lambda name: TITLES[name]),
        ("lasts, s", lambda name: f"{study.taught(name)[0].teaching_s:g}"),
        *((_SAID[kind], said(kind)) for kind in WorkloadMinute._fields),
        ("+1", counted(lambda each: each.positive_rewards)),
        ("-1", counted(lambda each: each.negative_rewards)),
        ("too late", counted(lambda each: each.refused_signals)),
        ("withdrawn", counted(lambda each: each.withdrawn)),
        note="Medians of all robots; in brackets in a minute. Phases 1 and 2 are one lesson. Set down: the robot was "
        "carried elsewhere as planned. Shown: the critic was shown an action. Rescued: the robot was carried away, "
        "because it got nowhere. Go: it was sent on after a stop of the guard. Too late: rewards and appraisals that "
        "the robot refused.",
    )


def critic_table(study: PhasesStudy) -> Table:
    """Return the table of the critic: appraisals and agreement."""
    ends = [each.agreement[-1] for each in study.taught(PHASE_4) if each.agreement]
    shares = [share for share in ends if share is not None]

    def of_phase_4(text: Callable[[Sequence[float]], str], without: str) -> Callable[[str], str]:
        # Other steps have no teacher to agree with: their agreement is that of phase 4, or made up.
        return lambda name: "" if name != PHASE_4 else text(shares) if shares else without

    return table_of(
        "The critic",
        (PHASE_4, PHASE_5, CRITIC_ALONE, SHUFFLED, INTACT),
        ("step", lambda name: TITLES[name]),
        ("appraisal RLAs", lambda name: f"{median(stage.appraisals for stage in study.stages[name]):g}"),
        ("agreement at its end", of_phase_4(lambda shares: f"{median(shares):.2f}", "too little heard")),
        ("quartiles", of_phase_4(lambda shares: to_text(quartiles(shares)[::2], ".2f"), "")),
        (
            "trusted",
            lambda name: of_text(sum(t.share_trusted > 0 for t in study.taught(name)), len(study.taught(name))),
        ),
        ("changes", lambda name: f"{median(each.critics_changes for each in study.taught(name)):g}"),
        ("undone", lambda name: f"{median(each.rolled_back for each in study.taught(name)):g}"),
        note="Agreement with the teacher's signals of phase 4, before they were learnt. Trusted: robots in which it "
        "ever was. Changes of actions and RLAs that it made, and those that were undone since its score fell.",
    )


def judged_table(study: PhasesStudy) -> Table:
    """Return the table of the opinions of critic and judge."""
    robots = [stage.judgements for stage in study.stages[JUDGED]]
    together, scores = score_of([each for robot in robots for each in robot]), [score_of(each) for each in robots]

    def cells(words: str, name: str) -> tuple[str, str, str, str]:
        shares = [share for share in (getattr(each, name) for each in scores) if share is not None]
        if not shares:
            return words, "nothing", "", ""
        return words, f"{getattr(together, name):.2f}", f"{median(shares):.2f}", to_text(quartiles(shares)[::2], ".2f")

    return Table(
        "The critic, judged",
        ("share", "all robots together", "median robot", "quartiles"),
        (
            cells("of what it calls bad is bad", "precision"),
            cells("of what is bad it calls so", "recall"),
            cells("agreement, mean of bad and good", "agreement"),
            cells("does not know", "silent"),
        ),
        note="After phase 4, in a drive by the corrupted set of the branches in the world that is taught in: tick by "
        "tick with the judge, and nothing is learnt. The critic has not seen these wrong actions.",
    )


def autonomous_table(study: PhasesStudy) -> Table:
    """Return the table of the drives without a teacher."""

    def rate(name: str, count: Callable[[TeachingOutcome], int]) -> Rate:
        taught = study.taught(name)
        return rate_of([count(each) for each in taught], [each.teaching_s / TEN_MIN_S for each in taught])

    return table_of(
        "While it learnt alone",
        (CRITIC_ALONE, SHUFFLED, INTACT, PHASE_5),
        ("step", lambda name: TITLES[name]),
        ("lasts, s", lambda name: f"{study.taught(name)[0].teaching_s:g}"),
        *_collision_columns(lambda name: rate(name, lambda each: each.collisions)),
        ("rescues in 10 min", lambda name: f"{rate(name, lambda each: each.rescues).value:.2f}"),
        ("unknown", lambda name: f"{median(each.share_unknown for each in study.taught(name)):.1%}"),
        note="In the world that is taught in.",
    )


def long_run_table(study: PhasesStudy) -> Table:
    """Return the table of interventions in the long run."""
    return table_of(
        "Interventions in the long run after phase 5",
        [study.taught(LONG_RUN)],
        ("hours", lambda taught: f"{sum(each.teaching_s for each in taught) / _HOUR_S:.1f}"),
        ("collisions", lambda taught: sum(each.collisions for each in taught)),
        ("stuck", lambda taught: sum(each.rescues - each.unknown_rescues for each in taught)),
        ("unknown for long", lambda taught: sum(each.unknown_rescues for each in taught)),
        ("stopped", lambda taught: sum(each.alarms for each in taught)),
        ("an hour", lambda _: f"{interventions(study).value:.2f}"),
        ("95 %", lambda _: to_text(interventions(study)[1:], ".2f")),
        words=0,
        note=f"{robots_of_the_long_run(study)}. All together, in the world that is taught in; the critic goes on.",
    )


def words_of_controls(study: PhasesStudy) -> Iterator[str]:
    """Yield sentences on controls without effect."""
    stages = study.stages
    robots = len(stages[ASKS])
    if not any(each.asks for each in study.taught(ASKS)):
        yield f"{TITLES[ASKS]}: no robot asked anything."
    never = sum(each.negative_rewards == 0 for each in study.taught(UNKNOWN_BAD))
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


def settings_table(task: TaskSettings) -> Table:
    """Return the table of the settings of phases 3 to 5 and of the critic.

    Raises config.settings.SettingsError if the task has no section on phases.
    """
    of: dict[str, Any] = {
        "phases": phases_of(task).model_dump(mode="json", exclude={"asked"}),
        "reinforcement": task.reinforcement.model_dump(mode="json"),
        "judge": task.judge.model_dump(mode="json") if task.judge else {},
        "critic": load_critic(task.critic).model_dump(mode="json"),
    }
    rows = tuple(_told(of, ""))
    return Table("Settings of phases 3 to 5", ("setting", "value"), rows, words=2)


def _told(value: Any, name: str) -> Iterator[tuple[str, str]]:
    if isinstance(value, dict):
        for key, each in value.items():
            yield from _told(each, f"{name}.{key}" if name else key)
    elif isinstance(value, list) and any(isinstance(each, dict) for each in value):
        for number, each in enumerate(value):
            yield from _told(each, f"{name}.{number}")
    elif isinstance(value, list):
        yield name, ", ".join(map(str, value))
    else:
        yield name, f"{value:g}" if isinstance(value, float) else str(value)


def write_phases(study: PhasesStudy, pictures: Sequence[SavedFigure], command: str, path: Path) -> None:
    """Write the report as an HTML page.

    `command`: typed words, without those that belong to the machine alone. Raises OSError, and SettingsError if the
    task has no section on phases.
    """
    plan, seeds = study.plan, spans(study.plan.seeds)
    reasons = list(reasons_not_to_judge(plan))
    told = (
        "A simulated robot is trained through all phases by a scripted teacher, over the commands that a person uses, "
        f"once per seed ({seeds}): answers (1), corrections (2), rewards (3), a critic of its own is taught (4), and "
        "it goes on alone with what that critic thinks (5). After each phase it is examined without its teacher. Next "
        "to the path stand branches: the set of phase 2 with wrong actions, left as it is or repaired in several ways. "
        "A seed makes the robot with the spread of its sensors, its noise and its start. What is missed stands here as "
        "it came."
    )
    write_report(
        path,
        f"KURT2: {plan.about.task.name.replace('_', ' ')}, phases 1 to 5",
        (
            Section("", (told,)),
            Section("Tables", tables=list(all_tables(study, reasons))),
            Section("Figures", pictures=pictures),
            Section("How this was made", tables=(settings_table(plan.about.task),)),
        ),
        reasons=reasons,
        command=command,
        footer=f"Seeds {seeds}. {{versions}}. Source: {{source}}. The same command with the same versions gives the "
        "same numbers on the same kind of machine. What a robot knew after a step: `kurt2rt knowledge show` with a "
        "file of the folder `knowledge` next to this report.",
    )
