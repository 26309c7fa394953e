"""Outcomes of robots, written by hand."""

from collections.abc import Sequence

from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.paper.outcome import DriveOutcome, Reading, TaughtOutcome
from kurt2rt.experiments.paper.plan import PaperExperiment
from kurt2rt.experiments.paper.settings import ExperimentSettings, load_paper
from kurt2rt.experiments.paper.summary import PaperSummary, summarize
from kurt2rt.experiments.study.provenance import Provenance

MADE_OF = Provenance(task="t", robot="r", worlds="w", source="s", versions="Python 3")


def drive(
    world: str = "a",
    *,
    succeeded: bool = True,
    collisions: int = 0,
    stuck: bool = False,
    duration_s: float = 300.0,
    progress: float = 8.0,
    findings: dict[str, float] | None = None,
    teachers_progress: float = 9.0,
    teachers_collisions: int = 0,
    teachers_stuck: bool = False,
    teachers_alarm: str = "",
    least_progress: float = 0.0,
) -> DriveOutcome:
    return DriveOutcome(
        world=world,
        unit="laps",
        progress=progress,
        teachers_progress=teachers_progress,
        teachers_collisions=teachers_collisions,
        teachers_stuck=teachers_stuck,
        teachers_alarm=teachers_alarm,
        succeeded=succeeded,
        duration_s=duration_s,
        way_m=70.0,
        collisions=collisions,
        stuck=stuck,
        alarm="",
        share_unknown=0.034,
        findings={"distance error, m": 0.05} if findings is None else findings,
        trail=((1.0, 1.0), (1.1, 1.0), (1.2, 1.1)),
        asked_at=((1.1, 1.0),),
        collided_at=((1.2, 1.1),) * collisions,
        least_progress=least_progress,
    )


def robot(seed: int, rlas: int, *drives: DriveOutcome, rlas_of: dict[str, int] | None = None) -> TaughtOutcome:
    return TaughtOutcome(
        made_of=MADE_OF,
        seed=seed,
        teaching_s=345.0,
        rlas=rlas,
        rlas_of=rlas_of or {},
        knowledge_hash="0" * 64,
        asks=41,
        corrections=52,
        rescues=3,
        alarms=0,
        drives=drives,
    )


def settings_of(task: str) -> ExperimentSettings:
    return next(each for each in load_paper().experiments if each.task == task)


def summary_of(task: str, robots: Sequence[TaughtOutcome], reading: Reading = "shipped") -> PaperSummary:
    return summarize(PaperExperiment(settings_of(task), reading, load_task(task), ()), robots)
