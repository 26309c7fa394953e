"""Tables of the phases study with its verdicts, and its report."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from behaviors.metrics.task_metric import DISTANCE_ERROR
from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.teacher_workload import WorkloadMinute
from kurt2rt.experiments.phases.figures import draw_figures
from kurt2rt.experiments.phases.results import (
    HOUR_S,
    Paired,
    PhasesStudy,
    Stage,
    exams_of,
    interventions,
    paired,
    read_study,
    reasons_not_to_judge,
    robots_of_the_long_run,
    score_of,
    verdicts,
)
from kurt2rt.experiments.phases.steps import BRANCHES, PATH, Step, phases_of
from kurt2rt.experiments.phases.study import PhasesTask
from kurt2rt.experiments.study.exam_tables import (
    PROGRESS,
    PROGRESS_QUARTILES,
    STUCK,
    UNKNOWN,
    WORLD,
    by_world,
    collision_columns,
    measure_column,
    success_text,
)
from kurt2rt.experiments.study.intervals import TEN_MIN_S, Rate, quartiles, rate_of
from kurt2rt.experiments.study.report import TO_SEE_LESSONS, Section, spans, tell_with_report
from kurt2rt.experiments.study.study_plan import Group, StudyPlan
from kurt2rt.experiments.study.table import (
    Column,
    Table,
    Told,
    brief,
    median,
    middle,
    of_text,
    rate_columns,
    settings_table,
    share_text,
    table_of,
    targets_table,
    to_text,
    total,
)

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


def phases_targets_table(study: PhasesStudy, not_judged_because: Sequence[str]) -> Table:
    """Return the table of all targets with their results; with reasons against judging, none is judged."""
    found = [((), each) for each in verdicts(study)]
    return targets_table(found, not_judged_because, note_without_targets="Of this task nothing is asked.")


def all_tables(study: PhasesStudy, reasons: Sequence[str]) -> Iterator[Table]:
    """Yield all tables. `reasons`: those against judging.

    Raises config.settings.SettingsError if the task has no section on phases.
    """
    yield phases_targets_table(study, reasons)
    taught_by = f"Taught by the scripted teacher {study.plan.about.task.teaching.profile.name}."
    yield _exam_table("Phase by phase", PATH, study, f"{taught_by} {SUCCESS} {_PHASE_4}")
    yield _teachers_table(study)
    yield _workload_table("What the teacher had to do", (Step.PHASE_2, Step.PHASE_3, Step.PHASE_4), study)
    yield _critic_table(study)
    yield _judged_table(study)
    yield _exam_table(
        f"A set of phase 2 with {phases_of(study.plan.about.task).corrupted_share:.0%} wrong actions, and its repair",
        BRANCHES,
        study,
        "All branches begin with the same set of each robot. Asks only: the teacher answers, no more. Unknown is -1: "
        "he also blames what led into a situation that the robot does not know. By chance: he blames whatever drives "
        "now and then, and answers where the robot asks again. Critic alone: there is no teacher to ask. "
        "Shuffled: the same appraisals with their opinions shuffled, trusted all the same. "
        + " ".join(words_of_controls(study)),
    )
    yield _workload_table("What that took", (Step.ASKS, Step.UNKNOWN_BAD, Step.BLAME_BY_CHANCE, Step.REWARDS), study)
    yield _autonomous_table(study)
    for title, before, after in (
        ("What rewards add to answers alone", Step.ASKS, Step.REWARDS),
        ("What judging adds to blame by chance", Step.BLAME_BY_CHANCE, Step.REWARDS),
        ("What its opinions add to the shuffled critic", Step.SHUFFLED, Step.CRITIC_ALONE),
        ("An intact set, before and after phase 5", Step.PHASE_2, Step.INTACT),
        ("The set of phase 2, and after all phases", Step.PHASE_2, Step.PHASE_5),
    ):
        yield _paired_table(title, paired(study.stages[before], study.stages[after]))
    yield _long_run_table(study)


def _exam_table(title: str, stages: Sequence[Step], study: PhasesStudy, note: str) -> Table:
    def of_stage(heading: str, name: str) -> Column:
        of = middle(heading, name)[1]
        return heading, lambda each: of(study.stages[each.of]) if each.is_first else ""

    return table_of(
        title,
        exams_of(*(study.stages[name] for name in stages)),
        ("stage", lambda each: each.of.label if each.is_first else ""),
        WORLD,
        of_stage("RLAs", "rlas"),
        ("success", lambda each: of_text(each.passed, len(each.rows))),
        ("95 %", lambda each: share_text(each.passed, len(each.rows))),
        *collision_columns(),
        STUCK,
        PROGRESS,
        PROGRESS_QUARTILES,
        UNKNOWN,
        middle("changes/s", "action_changes_per_s", ".2f"),
        measure_column(DISTANCE_ERROR, "distance error, m"),
        of_stage("still withdrawn", "still_withdrawn"),
        words=2,
        note=note,
    )


def _paired_table(title: str, pairs: Sequence[Paired]) -> Table:
    return table_of(
        title,
        pairs,
        WORLD,
        ("measure", lambda each: each.measure.name),
        ("before", lambda each: f"{each.before:.3f}"),
        ("after", lambda each: f"{each.after:.3f}"),
        ("change", lambda each: f"{each.difference.value:+.3f}"),
        ("95 %", lambda each: to_text(each.difference[1:], "+.3f")),
        ("better", lambda each: each.robots(+1)),
        ("worse", lambda each: each.robots(-1)),
        ("no longer clean", lambda each: "" if each.measure.clean is None else each.no_longer_clean),
        ("surely", lambda each: each.surely),
        words=2,
        note=_PAIRED,
    )


def _teachers_table(study: PhasesStudy) -> Table:
    return table_of(
        "How the teacher drives himself",
        by_world(None, study.teachers),
        WORLD,
        ("without fault", lambda each: of_text(each.passed, len(each.rows))),
        collision_columns()[0],
        STUCK,
        PROGRESS,
        PROGRESS_QUARTILES,
        ("seeds that failed", lambda each: ", ".join(str(row.seed) for row in each.rows if not row.passed) or "none"),
        note="By his policy from the starts of the exams: what progress is measured by. Where he failed himself, a "
        "robot that does as he does cannot be without fault.",
    )


_STEP: Column = ("step", lambda stage: stage.of.label)
_LASTS: Column = ("lasts, s", lambda stage: f"{stage.rows[0].teaching.teaching_s:g}")


def _workload_table(title: str, steps: Sequence[Step], study: PhasesStudy) -> Table:
    def said(kind: str) -> Callable[[Any], str]:
        def cell(stage: Any) -> str:
            taught = [robot.teaching for robot in stage.rows]
            of_robot = median(sum(getattr(minute, kind) for minute in each.workload) for each in taught)
            return f"{of_robot:g} ({of_robot / (taught[0].teaching_s / 60.0):.1f})"

        return cell

    return table_of(
        title,
        [study.stages[name] for name in steps],
        _STEP,
        _LASTS,
        *((_SAID[kind], said(kind)) for kind in WorkloadMinute._fields),
        middle("+1", "teaching.positive_rewards"),
        middle("-1", "teaching.negative_rewards"),
        middle("too late", "teaching.refused_signals"),
        middle("withdrawn", "teaching.withdrawn"),
        note="Medians of all robots; in brackets in a minute. Phases 1 and 2 are one lesson. Set down: the robot was "
        "carried elsewhere as planned. Shown: the critic was shown an action. Rescued: the robot was carried away, "
        "because it got nowhere. Go: it was sent on after a stop of the guard. Too late: rewards and appraisals that "
        "the robot refused.",
    )


def _critic_table(study: PhasesStudy) -> Table:
    ends = [each.agreement[-1] for each in study.taught(Step.PHASE_4) if each.agreement]
    shares = [share for share in ends if share is not None]

    def of_phase_4(text: Callable[[Sequence[float]], str], without: str) -> Callable[[Stage], str]:
        # Other steps have no teacher to agree with: their agreement is that of phase 4, or made up.
        return lambda stage: "" if stage.of != Step.PHASE_4 else text(shares) if shares else without

    def trusted(stage: Any) -> str:
        return of_text(sum(robot.teaching.share_trusted > 0 for robot in stage.rows), len(stage.rows))

    return table_of(
        "The critic",
        [study.stages[name] for name in (Step.PHASE_4, Step.PHASE_5, Step.CRITIC_ALONE, Step.SHUFFLED, Step.INTACT)],
        _STEP,
        middle("appraisal RLAs", "appraisals"),
        ("agreement at its end", of_phase_4(lambda shares: f"{median(shares):.2f}", "too little heard")),
        ("quartiles", of_phase_4(lambda shares: to_text(quartiles(shares)[::2], ".2f"), "")),
        ("trusted", trusted),
        middle("changes", "teaching.critics_changes"),
        middle("undone", "teaching.rolled_back"),
        note="Agreement with the teacher's signals of phase 4, before they were learnt. Trusted: robots in which it "
        "ever was. Changes of actions and RLAs that it made, and those that were undone since its score fell.",
    )


def _judged_table(study: PhasesStudy) -> Table:
    robots = [stage.judgements for stage in study.stages[Step.JUDGED].rows]
    scores = [score_of(each) for each in robots]

    def cells(words: str, together: float | None) -> tuple[str, str, str, str]:
        shares = [share for share in (each[words] for each in scores) if share is not None]
        if together is None:
            return words, "nothing", "", ""
        return words, f"{together:.2f}", f"{median(shares):.2f}", to_text(quartiles(shares)[::2], ".2f")

    return Table(
        "The critic, judged",
        ("share", "all robots together", "median robot", "quartiles"),
        tuple(cells(*share) for share in score_of([each for robot in robots for each in robot]).items()),
        note="After phase 4, in a drive by the corrupted set of the branches in the world that is taught in: tick by "
        "tick with the judge, and nothing is learnt. The critic has not seen these wrong actions.",
    )


def _autonomous_table(study: PhasesStudy) -> Table:
    def in_10_min(count: str) -> Callable[[Any], Rate]:
        return lambda stage: rate_of(
            [getattr(robot.teaching, count) for robot in stage.rows],
            [robot.teaching.teaching_s / TEN_MIN_S for robot in stage.rows],
        )

    return table_of(
        "While it learnt alone",
        [study.stages[name] for name in (Step.CRITIC_ALONE, Step.SHUFFLED, Step.INTACT, Step.PHASE_5)],
        _STEP,
        _LASTS,
        *rate_columns("collisions in 10 min", in_10_min("collisions")),
        rate_columns("rescues in 10 min", in_10_min("rescues"))[0],
        middle("unknown", "teaching.share_unknown", ".1%"),
        note="In the world that is taught in.",
    )


def _long_run_table(study: PhasesStudy) -> Table:
    return table_of(
        "Interventions in the long run after phase 5",
        [Group(Step.LONG_RUN, tuple(study.taught(Step.LONG_RUN)))],
        ("hours", lambda each: f"{sum(taught.teaching_s for taught in each.rows) / HOUR_S:.1f}"),
        total("collisions", "collisions"),
        ("stuck", lambda each: sum(taught.rescues - taught.unknown_rescues for taught in each.rows)),
        total("unknown for long", "unknown_rescues"),
        total("stopped", "alarms"),
        *rate_columns("an hour", lambda _: interventions(study)),
        words=0,
        note=f"{robots_of_the_long_run(study)}. All together, in the world that is taught in; the critic goes on.",
    )


def words_of_controls(study: PhasesStudy) -> Iterator[str]:
    """Yield sentences on controls without effect."""
    stages = study.stages
    robots = len(stages[Step.ASKS].rows)
    if not any(each.asks for each in study.taught(Step.ASKS)):
        yield f"{Step.ASKS.label}: no robot asked anything."
    never = sum(each.negative_rewards == 0 for each in study.taught(Step.UNKNOWN_BAD))
    if never:
        yield f"{Step.UNKNOWN_BAD.label}: {never} of {robots} robots never met the unknown, so no -1 came."
    for one, other in (
        (Step.ASKS, Step.CORRUPTED),
        (Step.UNKNOWN_BAD, Step.ASKS),
        (Step.BLAME_BY_CHANCE, Step.ASKS),
        (Step.REWARDS, Step.ASKS),
        (Step.CRITIC_ALONE, Step.CORRUPTED),
        (Step.SHUFFLED, Step.CORRUPTED),
    ):
        same = sum(a.exams == b.exams for a, b in zip(stages[one].rows, stages[other].rows, strict=True))
        if same:
            yield f"{one.label}: {same} of {robots} robots drive exactly as in '{other.label}'."


def _settings_table(task: TaskSettings) -> Table:
    of: dict[str, Any] = {
        "phases": phases_of(task).model_dump(mode="json", exclude={"asked"}),
        "reinforcement": task.reinforcement.model_dump(mode="json"),
        "judge": task.judge.model_dump(mode="json") if task.judge else {},
        "critic": load_critic(task.critic).model_dump(mode="json"),
    }
    return settings_table("Settings of phases 3 to 5", {"value": of})


def tell(plan: StudyPlan[PhasesTask], command: str) -> Told:
    """Write figures and report into the folder of the results; return the tables.

    `command`: typed words, without those that belong to the machine alone. Raises StudyError, OSError, and
    SettingsError if the task has no section on phases.
    """
    study, reasons = read_study(plan), list(reasons_not_to_judge(plan))
    tables = list(all_tables(study, reasons))
    taught, at_end = (
        success_text([exam for robot in study.stages[step].rows for exam in robot.exams])
        for step in (Step.PHASE_2, Step.PHASE_5)
    )
    sentence = f"Exams passed without a teacher: {taught} after answers and corrections; {at_end} after all phases."
    about = (
        "A simulated robot is trained through all phases by a scripted teacher, over the commands that a person uses, "
        f"once per seed ({spans(plan.seeds)}): answers (1), corrections (2), rewards (3), a critic of its own is "
        "taught (4), and it goes on alone with what that critic thinks (5). After each phase it is examined without "
        "its teacher. Next to the path stand branches: the set of phase 2 with wrong actions, left as it is or "
        "repaired in several ways. A seed makes the robot with the spread of its sensors, its noise and its start. "
        "What is missed stands here as it came."
    )
    title = f"KURT2: {plan.about.task.name.replace('_', ' ')}, phases 1 to 5"
    told, folder = Told(tables, sentence, (about,), brief(tables[0]), reasons), plan.results.folder
    settings = [Section("Settings", tables=(_settings_table(plan.about.task),))]
    return tell_with_report(folder, title, told, command, list(draw_figures(study, folder)), settings, TO_SEE_LESSONS)
