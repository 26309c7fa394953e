"""Study of doubt: jobs of one robot in one world, which only tells its doubt, or stands; and their tables."""

from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, NamedTuple

from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.doubt.drive import (
    DoubtResponse,
    DoubtRun,
    DoubtSetup,
    DriveLog,
    judge_score,
    threshold_for,
    with_doubt,
)
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.exam import ExamSetup, build_exam_runtime
from kurt2rt.experiments.study.figures import Estimate, draw_estimates, saved
from kurt2rt.experiments.study.intervals import Rate, rate_of
from kurt2rt.experiments.study.jobs import JobParts, Outcome, StudyJob, require_places, world_of
from kurt2rt.experiments.study.provenance import Fingerprints
from kurt2rt.experiments.study.report import tell_with_report
from kurt2rt.experiments.study.study_plan import Group, StudyPlan, read_groups
from kurt2rt.experiments.study.table import Table, Told, of_text, rate_text, table_of
from kurt2rt.knowledge.journal.loading import read_lessons
from kurt2rt.runtime import RuntimeOptions

TICKS_PER_MINUTE = 6000


class DoubtOutcome(Outcome):
    """Stored outcome of one job: the log of a robot's drive in one world."""

    log: DriveLog


@dataclass(frozen=True, slots=True, kw_only=True)
class DoubtJob(StudyJob):
    """Drive of one taught robot in one world, with one response to its doubt."""

    outcome = DoubtOutcome
    keeps_knowledge: ClassVar[bool] = False
    taught: Path
    """File with the lessons of the robot."""
    setup: DoubtSetup

    async def measure(self, knowledge: Path, report: Report) -> DoubtOutcome:  # noqa: ARG002 - nothing is taught
        """Drive in the job's world and return the log."""
        setup, task = self.setup, with_doubt(self.task, self.setup.response)
        exam = ExamSetup(setup.world, setup.seed, events=read_lessons(self.taught, self.robot, self.task))
        with closing(self.factory.open(setup.world, setup.seed, "doubt")) as simulation:
            runtime = build_exam_runtime(simulation, self.robot, task, exam, RuntimeOptions())
            run = DoubtRun(simulation, runtime, setup, lambda done_s: report(self.name, done_s, self.robot_time_s))
            await run.run(round(setup.duration_s / run.period_s))
            return DoubtOutcome(made_of=self.made_of, seed=self.seed, log=run.log())


class DoubtDrives(NamedTuple):
    """Subject of a study of doubt: the task, and worlds, responses and duration of its drives."""

    task: TaskSettings
    worlds: tuple[str, ...]
    """SEED in a name stands for the robot's seed."""
    responses: tuple[DoubtResponse, ...]
    seconds: float
    """Duration of each drive."""
    set_down_after_s: float
    """Time after which a robot that asks is set down at another start; 0: it is not."""


def make_plan(about: DoubtDrives, seeds: Sequence[int], taught: Path, parts: JobParts) -> StudyPlan[DoubtDrives]:
    """Check task and worlds, and return the jobs; `taught`: folder with one knowledge file per seed.

    Raises KnowledgeError, and config.settings.SettingsError if the task sets no doubt, or does not fit a world.
    """
    task = with_doubt(about.task, DoubtResponse.TELLS)
    require_places(parts["factory"], task, (world_of(world, seed) for world in about.worlds for seed in seeds))
    fingerprints = Fingerprints(parts["factory"], parts["robot"])
    files = {seed: taught / f"{task.name}-{seed}.knowledge" for seed in seeds}
    lessons = {seed: repr(read_lessons(file, parts["robot"], task)) for seed, file in files.items()}

    def job(response: DoubtResponse, seed: int, place: str) -> DoubtJob:
        world = world_of(place, seed)
        setup = DoubtSetup(world, seed, about.seconds, response, about.set_down_after_s)
        return DoubtJob(
            **parts,
            task=task,
            seed=seed,
            made_of=fingerprints.of(task, (world,), lessons[seed], repr(setup)),
            name=f"{task.name}, {response}, seed {seed}, world {world}",
            stem=f"{response.name.lower()}/{Path(world).stem}/{task.name}-{seed}",
            robot_time_s=about.seconds,
            taught=files[seed],
            setup=setup,
        )

    jobs = (job(response, seed, world) for response in about.responses for seed in seeds for world in about.worlds)
    return StudyPlan(about, tuple(seeds), tuple(jobs))


def tell(plan: StudyPlan[DoubtDrives], command: str) -> Told:
    """Return the quality of doubt that is only told, if it is driven, and the collisions by response, with a report.

    `command`: typed words, without those that belong to the machine alone. Raises OSError, and StudyError if a result
    is missing or damaged.
    """
    found = read_groups(plan.of(DoubtJob), lambda job: job.setup.response, DoubtOutcome)
    groups = [Group(each.of, tuple(outcome.log for outcome in each.rows)) for each in found]
    doubt = plan.about.task.learning.doubt
    tables = [score_table(each.rows, doubt.threshold) for each in groups if doubt and each.of is DoubtResponse.TELLS]
    collisions = collision_table(groups, plan.about.set_down_after_s)
    counts = ", ".join(f"{each.of.value} {_collisions(each)}" for each in groups)
    rates = [(each.of.value, _collisions(each), _rate(each)) for each in groups]
    figure = draw_estimates([Estimate(of, *rate, f"{count} collisions") for of, count, rate in rates], "in 100 min")
    caption = "By what doubt does; all drives from the same starts."
    picture = saved(figure, plan.results.folder / "doubt.png", "Collisions in 100 minutes", caption)
    sentence = f"Collisions in {len(groups[0].rows)} drives without a teacher, by what doubt does: {counts}."
    told = Told([*tables, collisions], sentence, short=collisions)
    title = f"KURT2: doubt in {plan.about.task.name}"
    return tell_with_report(plan.results.folder, title, told, command, [picture])


def _collisions(each: Group[DoubtResponse, DriveLog]) -> int:
    return sum(len(log.collisions) for log in each.rows)


def _rate(each: Group[DoubtResponse, DriveLog]) -> Rate:
    """Return the collisions in 100 minutes."""
    hundreds = [len(log.doubt) / TICKS_PER_MINUTE / 100 for log in each.rows]
    return rate_of([len(log.collisions) for log in each.rows], hundreds)


def score_table(logs: Sequence[DriveLog], threshold: float) -> Table:
    """Return the quality of doubt at its threshold, and of distance / R with no more questions, of drives on end.

    `threshold`: score of doubt, dimensionless.
    """
    doubt, distance = [log.doubt for log in logs], [log.distance for log in logs]
    minutes = sum(float(log.driving.sum()) for log in logs) / TICKS_PER_MINUTE
    collisions, seen = sum(len(log.collisions) for log in logs), sum(sum(log.seen) for log in logs)
    found = judge_score(logs, doubt, threshold)
    control = judge_score(logs, distance, threshold_for(logs, distance, found.questions))
    return table_of(
        f"Doubt that is only told, {len(logs)} drives, {minutes:.0f} minutes",
        (("doubt", found), ("distance / R", control)),
        ("score", lambda row: row[0]),
        ("AUC", lambda row: f"{row[1].auc:.2f}"),
        ("collisions caught", lambda row: of_text(row[1].caught, collisions)),
        ("with things seen", lambda row: of_text(row[1].caught_seen, seen)),
        ("questions in 2 min", lambda row: f"{2 * row[1].questions / max(minutes, 1e-9):.2f}"),
        ("of them false", lambda row: f"{2 * row[1].false_questions / max(minutes, 1e-9):.2f}"),
        note="Wrong: the policy turns away and the robot does not, for 0.3 s; or a collision follows within 2 s. "
        "Seen: a sensor saw it before, where the robot touches it; a thin thing may stand between all beams.",
    )


def collision_table(groups: Sequence[Group[DoubtResponse, DriveLog]], set_down_after_s: float) -> Table:
    """Return the collisions of drives by the robot's response to its doubt; all have as many drives.

    `set_down_after_s`: time after which a robot that asks was set down at another start; 0: it was not.
    """

    def minutes(each: Group[DoubtResponse, DriveLog], *, driven: bool = False) -> float:
        ticks = sum(float(log.driving.sum()) if driven else len(log.doubt) for log in each.rows)
        return max(ticks / TICKS_PER_MINUTE, 1e-9)

    return table_of(
        f"Collisions without a teacher, {max((len(each.rows) for each in groups), default=0)} drives each",
        groups,
        ("doubt", lambda each: each.of.value),
        ("collisions", _collisions),
        ("with things seen", lambda each: sum(sum(log.seen) for log in each.rows)),
        ("in 100 min (95 % interval)", lambda each: rate_text(_rate(each), ".1f")),
        ("in 100 driven min", lambda each: f"{100 * _collisions(each) / minutes(each, driven=True):.1f}"),
        ("time driven", lambda each: f"{100 * minutes(each, driven=True) / minutes(each):.0f} %"),
        ("m in a minute", lambda each: f"{sum(log.travelled_m for log in each.rows) / minutes(each):.1f}"),
        note=f"A question that is not answered for {set_down_after_s:g} s sets the robot down at another start."
        if set_down_after_s
        else "A robot that asks stands for as long as its question lasts.",
    )
