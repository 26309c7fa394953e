"""How robots drive at each stage."""

from collections.abc import Sequence

from kurt2rt.experiments.lockstep.report import quartiles
from kurt2rt.experiments.phases.steps import TITLES
from kurt2rt.experiments.phases.study import PhasesStudy
from kurt2rt.experiments.phases.summary import worlds_of
from kurt2rt.experiments.study.table import Table


def exam_sheet(title: str, stages: Sequence[str], study: PhasesStudy, note: str) -> Table:
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
    return Table(title, columns, tuple(rows), words=2, note=note)
