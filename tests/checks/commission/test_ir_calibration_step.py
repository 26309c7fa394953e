"""The infra-red law, by a ruler."""

import random
from pathlib import Path

import pytest

from kurt2rt.checks.commission.fault import FaultCode
from kurt2rt.checks.commission.ir_calibration import IrCalibrationError, IrLaw, IrReading, fit_law
from kurt2rt.checks.commission.ir_calibration_step import DISTANCES_M
from kurt2rt.checks.commission.operator import OperatorQuestion, QuestionKind
from kurt2rt.checks.commission.progress import StepOutcome
from tests.checks.commission.workshop import Session, Workshop

USUAL = IrLaw(86.016, 0.04, 64.4)


def readings(law: IrLaw, noise: float = 0.0, seed: int = 1) -> list[IrReading]:
    chance = random.Random(seed)
    return [
        IrReading("s11", distance_m, law.counts_at(distance_m) * (1.0 + noise * chance.uniform(-1.0, 1.0)))
        for distance_m in DISTANCES_M
    ]


# The fit


@pytest.mark.parametrize(
    ("taken", "code", "fields"),
    [
        (
            [IrReading("s11", d, 70.0) for d in DISTANCES_M],
            FaultCode.LAW_FLAT,
            {"near_counts": 70.0, "near_m": 0.1, "far_counts": 70.0, "far_m": 0.6},
        ),
        ([IrReading("s11", d, 400.0 - 100.0 * d) for d in DISTANCES_M], FaultCode.LAW_FLAT, {"near_counts": 390.0}),
        (readings(USUAL)[::-1][:3], FaultCode.LAW_DISTANCES, {"least": 4}),
        ([each for each in readings(USUAL) if each.distance_m >= 0.2], FaultCode.LAW_DISTANCES, {"least": 4}),
        (
            readings(IrLaw(25.0, 0.04, 0.0)),
            FaultCode.LAW_IMPLAUSIBLE,
            {"distance_m": 0.1, "least_counts": 250.0, "most_counts": 1000.0},
        ),
        (
            [IrReading("s11", d, c) for d, c in zip(DISTANCES_M, (540, 100, 500, 90, 300, 60, 200), strict=True)],
            FaultCode.LAW_SCATTER,
            {},
        ),
        ([IrReading("s11", d, USUAL.counts_at(0.7 - d)) for d in DISTANCES_M], FaultCode.LAW_FLAT, {"far_m": 0.6}),
    ],
    ids=["dead", "flat", "too few", "too far", "too weak", "scatter", "upside down"],
)
def test_fit_law_implausible_readings_are_refused(
    taken: list[IrReading], code: FaultCode, fields: dict[str, float]
) -> None:
    with pytest.raises(IrCalibrationError) as caught:
        fit_law(taken)
    fault = caught.value.fault
    assert (fault.code, frozenset(fault.fields)) == (code, code.fields)
    assert {name: fault.fields[name] for name in fields} == fields


# The step


async def test_an_odd_reading_is_left_out_and_shown(tmp_path: Path) -> None:
    def err(question: OperatorQuestion) -> str | None:
        if question.about is not QuestionKind.BOARD or question.distance_m != 0.30:
            return None
        workshop.hold_before(question.subject, 0.15)
        return ""

    with Workshop() as workshop:
        session = Session(workshop, tmp_path, err)
        await session.run("infrared")
    (odd,) = [line for line in session.measured("infrared") if "left out" in line]
    assert odd.startswith("s11 at 0.30 m: 3")
    assert session.outcome("infrared") is StepOutcome.PASSED


async def test_no_law_is_made_from_a_board_that_was_never_there(tmp_path: Path) -> None:
    def forget(question: OperatorQuestion) -> str | None:
        return "" if question.about is QuestionKind.BOARD else None

    with Workshop() as workshop:
        session = Session(workshop, tmp_path, forget)
        await session.run("infrared")
    assert session.outcome("infrared") is StepOutcome.FAILED
    assert session.progress.findings.law is None
    assert session.faults("infrared")[0].code is FaultCode.LAW_FLAT


async def test_a_room_that_was_not_clear_makes_no_law(tmp_path: Path) -> None:
    def stand_in_the_way(question: OperatorQuestion) -> str | None:
        if question.about is not QuestionKind.CLEAR:
            return None
        workshop.hold_before("s11", 0.2)
        return ""

    with Workshop() as workshop:
        session = Session(workshop, tmp_path, stand_in_the_way)
        await session.run("infrared")
    (fault,) = session.faults("infrared")
    assert fault.code is FaultCode.ROOM_NOT_CLEAR
    assert fault.fields["distance_m"] == pytest.approx(0.25, abs=0.05)
    assert session.progress.findings.law is None


async def test_a_sensor_that_does_not_exist_is_asked_for_again(tmp_path: Path) -> None:
    answers = iter(["s99", "s1"])

    def choose(question: OperatorQuestion) -> str | None:
        return next(answers) if question.about is QuestionKind.WHICH else None

    with Workshop() as workshop:
        session = Session(workshop, tmp_path, choose)
        await session.run("infrared")
    assert {question.subject for question in session.person.asked if question.about is QuestionKind.BOARD} == {"s1"}
