"""Tables of the settings that each task was taught and examined with."""

from kurt2rt.core.task_settings import FeatureWeight
from kurt2rt.experiments.paper.summary import PaperStudy
from kurt2rt.experiments.study.table import Table

SUCCESS = (
    "Success is an exam that ends neither stuck nor stopped by the guard, with no more collisions than allowed, more "
    "than no progress, at least the share that is asked of what the teacher's own policy reaches from the same start, "
    "and at least the share that is asked of the junctions. Where that policy itself gets nowhere, the exam is not "
    "judged and counts neither way."
)


def learning_table(study: PaperStudy) -> Table:
    """Return the table of the learning settings of each task and reading."""
    rows = []
    for each in study.summaries:
        learning, teaching, teacher = each.task.learning, each.task.teaching, each.task.teaching.teacher
        rows.append(
            (
                each.label,
                each.reading,
                f"{learning.radius:g}",
                f"{learning.past_weight:g}",
                _weights(learning.weights),
                f"{learning.insert_beyond_share:g}",
                f"{learning.minimum_action_s:g}",
                teaching.world,
                f"{teaching.supervised_s:g} + {teaching.corrections_s:g}",
                teaching.profile.name,
                f"{teacher.reaction_s:g}",
                f"{teacher.patience_s:g}",
                f"{teacher.error_rate:.0%}",
                f"after {teaching.rescue_after_s:g} s within {each.task.exam.stuck_within_m:g} m",
                f"every {teaching.reposition_every_s:g} s" if teaching.reposition_every_s else "never",
                _words(teaching.reposition_to),
            )
        )
    columns = (
        "task",
        "reading",
        "R",
        "weight of the averages",
        "weights that are not 1",
        "insert beyond, share of R",
        "an action lasts at least, s",
        "taught in",
        "phases 1 + 2, s",
        "teacher",
        "reaction, s",
        "patience, s",
        "wrong answers",
        "rescues",
        "re-positions",
        "sets it down at",
    )
    return Table("Settings of learning and of the scripted teacher", columns, tuple(rows), words=2)


def exams_table(study: PaperStudy) -> Table:
    """Return the table of the exam settings of each task."""
    rows = []
    for task in {each.task.name: each.task for each in study.summaries}.values():
        exam, success = task.exam, task.exam.success
        rows.append(
            (
                task.name.replace("_", " "),
                _words(exam.start),
                f"{exam.duration_s:g}",
                f"{exam.stuck_after_s:g}",
                f"{exam.stuck_within_m:g}",
                f"{success.collisions_at_most}",
                f"{success.progress_share:.0%}",
                f"{success.right_at_least:.0%}" if success.right_at_least else "",
            )
        )
    columns = (
        "task",
        "starts at",
        "lasts, s",
        "stuck after, s",
        "within, m",
        "collisions at most",
        "of the teacher's progress at least",
        "junctions right at least",
    )
    return Table("Settings of the exams", columns, tuple(rows), note=SUCCESS)


def _weights(weights: tuple[FeatureWeight, ...]) -> str:
    return "; ".join(f"{each.weight:g}: {', '.join(each.features)}" for each in weights) or "none"


def _words(place: str) -> str:
    return {"starts": "a start pose", "in_sight": "any place in sight"}[place]
