"""Tables of the phases study, in their order."""

from collections.abc import Iterator, Sequence
from typing import Any

from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.report import label_of, quartiles
from kurt2rt.experiments.phases.steps import (
    ASKS,
    BLAME_BY_CHANCE,
    BRANCHES,
    CRITIC_ALONE,
    INTACT,
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
from kurt2rt.experiments.phases.summary import Paired, PhasesStudy, collisions_of, paired, summarize, worlds_of
from kurt2rt.experiments.phases.training_tables import (
    autonomous_table,
    critic_table,
    judged_table,
    long_run_table,
    words_of_controls,
    workload_table,
)
from kurt2rt.experiments.phases.verdicts import verdicts
from kurt2rt.experiments.study.table import Table
from kurt2rt.experiments.study.targets_table import targets_table
from kurt2rt.experiments.study.verdict import Verdict

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


def phases_targets_table(study: PhasesStudy, not_judged_because: Sequence[str]) -> Table:
    """Return the table of all targets with their results; with reasons against judging, none is judged.

    Raises hal.settings.SettingsError if the task has no section on phases.
    """
    found: list[tuple[tuple[str, ...], Verdict]] = [((), each) for each in verdicts(study)]
    return targets_table(found, not_judged_because, note_without_targets="Of this task nothing is asked.")


def all_tables(study: PhasesStudy, reasons: Sequence[str]) -> Iterator[Table]:
    """Yield all tables. `reasons`: those against judging.

    Raises hal.settings.SettingsError if the task has no section on phases.
    """
    yield phases_targets_table(study, reasons)
    taught_by = f"Taught by the scripted teacher {study.plan.task.teaching.profile.name}."
    yield exam_table("Phase by phase", PATH, study, f"{taught_by} {SUCCESS} {_PHASE_4}")
    yield teachers_table(study)
    yield workload_table("What the teacher had to do", (PHASE_2, PHASE_3, PHASE_4), study)
    yield critic_table(study)
    yield judged_table(study)
    yield exam_table(
        f"A set of phase 2 with {phases_of(study.plan.task).corrupted_share:.0%} wrong actions, and its repair",
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
    yield paired_table(
        "What rewards add to answers alone", paired(study.stages[ASKS], study.stages[REWARDS]), f"{_PAIRED}"
    )
    yield paired_table(
        "What judging adds to blame by chance",
        paired(study.stages[BLAME_BY_CHANCE], study.stages[REWARDS]),
        _PAIRED,
    )
    yield paired_table(
        "What its opinions add to the shuffled critic",
        paired(study.stages[SHUFFLED], study.stages[CRITIC_ALONE]),
        _PAIRED,
    )
    yield paired_table(
        "An intact set, before and after phase 5", paired(study.stages[PHASE_2], study.stages[INTACT]), _PAIRED
    )
    yield paired_table(
        "The set of phase 2, and after all phases", paired(study.stages[PHASE_2], study.stages[PHASE_5]), _PAIRED
    )
    yield long_run_table(study)


def exam_table(title: str, stages: Sequence[str], study: PhasesStudy, note: str) -> Table:
    """Return the table of the exams at these stages, by name, world by world; `note` stands below it."""
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
    return Table(title, columns, tuple(rows), words=2, note=note)


def paired_table(title: str, pairs: Sequence[Paired], note: str) -> Table:
    """Return the table of the changes of the same robots between two stages; `note` stands below it."""
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
    return Table(title, columns, tuple(rows), words=2, note=note)


def teachers_table(study: PhasesStudy) -> Table:
    """Return the table of the drives of the teacher's own policy from the same starts."""
    rows = []
    for world in dict.fromkeys(exam.world for robot in study.teachers for exam in robot):
        drives = [exam for robot in study.teachers for exam in robot if exam.world == world]
        failed = [
            str(seed)
            for seed, robot in zip(study.plan.seeds, study.teachers, strict=True)
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
    return Table(
        "How the teacher drives himself",
        columns,
        tuple(rows),
        note="By his policy from the starts of the exams: what progress is measured by. Where he failed himself, a "
        "robot that does as he does cannot be without fault.",
    )


def settings_table(task: TaskSettings) -> Table:
    """Return the table of the settings of phases 3 to 5 and of the critic.

    Raises hal.settings.SettingsError if the task has no section on phases.
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
