"""Results as a lesson and its exams leave them, written by hand."""

from hal.simulation import Position
from kurt2rt.core.rla.rla import Origin, Phase, Rla
from kurt2rt.core.rla.usage_counter import StatisticsCounter
from kurt2rt.core.task_settings import SuccessSettings
from kurt2rt.experiments.lockstep.curriculum import CurriculumResult, WorldResult
from kurt2rt.experiments.lockstep.exam import ExamResult
from kurt2rt.experiments.lockstep.lesson import TrainingResult
from kurt2rt.experiments.lockstep.seed_result import SeedResult, seed_result
from kurt2rt.platform.ledger import TickTimer

TRAIL = (Position(0.5, 0.5), Position(0.6, 0.5), Position(0.7, 0.6))


def exam_result(world: str = "a", seed: int = 1, laps: float = 8.0, collisions: int = 0, **fields: bool) -> ExamResult:
    return ExamResult(
        world=world,
        seed=seed,
        duration_s=123.0 if fields.get("stuck") else 300.0,
        progress=laps,
        unit="laps",
        distance_travelled_m=10.0 * laps,
        collisions=collisions,
        stuck=fields.get("stuck", False),
        share_unknown=0.034,
        action_changes_per_s=1.5,
        trail=TRAIL,
        unknown_positions=TRAIL[:1],
        findings={"distance error, m": 0.0321},
    )


def world_result(learned: ExamResult, teachers_laps: float = 9.0) -> WorldResult:
    teacher = exam_result(learned.world, learned.seed, laps=teachers_laps)
    return WorldResult(learned, teacher, learned.verdict(teacher.progress, SuccessSettings()))


def curriculum_result(seed: int, rlas: int, *exams: ExamResult) -> CurriculumResult:
    origin = Origin("c", "Ann", Phase.SUPERVISED, 1)
    lesson = TrainingResult(
        seed=seed,
        world="a",
        teaching_s=345.0,
        rlas=tuple(Rla(number, (0.0,), "forward", None, origin) for number in range(1, rlas + 1)),
        knowledge_hash="0" * 64,
        asks=41,
        corrections=52,
        rescues=3,
        statistics=StatisticsCounter(),
        growth=tuple(range(rlas)),
        trail=TRAIL,
        ask_positions=TRAIL[1:],
        ledger=TickTimer(),
    )
    return CurriculumResult(lesson, tuple(world_result(each) for each in exams))


def robot_of_seed(seed: int, rlas: int, *exams: ExamResult) -> SeedResult:
    return seed_result(curriculum_result(seed, rlas, *exams))
