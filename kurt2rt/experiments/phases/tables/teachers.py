"""The yardstick: how the teacher drives himself."""

from kurt2rt.experiments.phases.study import PhasesStudy
from kurt2rt.experiments.phases.summary import collisions_of, summarize
from kurt2rt.experiments.study.table import Table


def teachers_sheet(study: PhasesStudy) -> Table:
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
    return Table(
        "How the teacher drives himself",
        columns,
        tuple(rows),
        note="By his policy from the starts of the exams: what progress is measured by. Where he failed himself, a "
        "robot that does as he does cannot be without fault.",
    )
