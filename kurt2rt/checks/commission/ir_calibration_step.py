"""Step that calibrates the infra-red sensors with a board at ruled distances."""

import statistics

from hal.kurt2_settings import Kurt2SensorSettings
from kurt2rt.checks.commission.fault import FaultCode, SkipCode, SkippedError
from kurt2rt.checks.commission.ir_calibration import IrCalibrationError, IrFit, IrReading, fit_law
from kurt2rt.checks.commission.operator import SKIP, AnswerChoice, OperatorQuestion, QuestionKind, Tone
from kurt2rt.checks.commission.progress import Findings, LawFound
from kurt2rt.checks.commission.sensors import SETTLE_S
from kurt2rt.checks.commission.step import StepResult
from kurt2rt.checks.commission.test_stand import TestStand

DISTANCES_M = (0.10, 0.15, 0.20, 0.30, 0.40, 0.50, 0.60)
_MEASURE_S = 1.0
_LEAST_FAR_M = 0.4


class IrCalibrationStep:
    """Step that measures the median over a second at each distance and fits one calibration."""

    name = "infrared"
    title = "The infra-red law, by a ruler"
    why = "Distances that behaviours keep are read off this law; sensors of one kind differ from those of another."
    what_to_do = (
        "A ruler and a flat, light board, at least 10 cm wide, upright and square to the beam. Distances count from "
        "the sensor's face. Two sensors are better than one."
    )
    moves = False
    blocks_driving = False

    async def run(self, stand: TestStand, findings: Findings) -> StepResult:
        """Ask for the sensors, then for the board at each distance; return the fitted law and the faults.

        Raises SkippedError if no sensor is chosen, AbortedError if the operator leaves, BusError.
        """
        result = StepResult(stand, findings.model_copy(update={"law": None}))
        chosen = await _choose(stand, findings)
        await stand.ask(
            OperatorQuestion(QuestionKind.CLEAR, "Step back: nothing within a metre.", (AnswerChoice("", "measure"),))
        )
        await stand.listen(SETTLE_S)
        heard = await stand.listen(_MEASURE_S)
        floors = [heard.median(_channel(sensor, findings)) for sensor in chosen]
        if None in floors:
            result.fail(FaultCode.CHANNEL_UNHEARD)
            return result
        floor = statistics.median([each for each in floors if each is not None])
        asked = [await _read(stand, each, distance_m, findings) for each in chosen for distance_m in DISTANCES_M]
        readings = [each for each in asked if each is not None]
        try:
            fit = fit_law(readings)
        except IrCalibrationError as error:
            result.faults.append(error.fault)
            result.measured += [f"{each.sensor} at {each.distance_m:.2f} m: {each.counts:.0f}" for each in readings]
            return result
        law = fit.law
        result.note(
            f"counts = {law.numerator_counts_m:.2f} / (distance + {law.offset_m:.4f} m) - {law.bias_counts:.1f}"
        )
        for row in _rows(readings, fit):
            result.note(row)
        result.note(f"nothing in view: {floor:.0f} counts")
        near_m = min(each.distance_m for each in readings)
        # The law falls to the empty reading there, if not beyond the farthest board.
        far_m = round(min(max(each.distance_m for each in readings), law.distance_m(floor)), 2)
        if far_m < _LEAST_FAR_M:
            result.fail(FaultCode.ROOM_NOT_CLEAR, distance_m=far_m)
            return result
        result.note(f"distances from {near_m:.2f} to {far_m:.2f} m can be told apart")
        law_found = LawFound(
            numerator_counts_m=round(law.numerator_counts_m, 3),
            offset_m=round(law.offset_m, 4),
            bias_counts=round(law.bias_counts, 2),
            near_m=near_m,
            far_m=far_m,
            floor_counts=round(floor),
            plateau_counts=round(law.counts_at(near_m)),
        )
        result.findings = findings.model_copy(update={"law": law_found})
        return result


async def _choose(stand: TestStand, findings: Findings) -> tuple[Kurt2SensorSettings, ...]:
    sensors = {sensor.name: sensor for sensor in stand.settings.infrared.sensors}
    usable = [name for name in sensors if name not in findings.dead_sensors]
    if not usable:
        raise SkippedError(SkipCode.NO_SENSOR)
    usual = next((name for name in usable if sensors[name].heading_deg == 0.0 and sensors[name].y_m == 0.0), usable[0])
    question = OperatorQuestion(
        QuestionKind.WHICH,
        f"Which sensors? Names with blanks between them, such as: {usual} {usable[0]}",
        (AnswerChoice("", f"{usual} alone"),),
        free=True,
    )
    while True:
        names = (await stand.ask(question)).split() or [usual]
        strange = [name for name in names if name not in usable]
        if not strange:
            return tuple(sensors[name] for name in dict.fromkeys(names))
        stand.tell(f"no such sensor, or a dead one: {', '.join(strange)}; there are: {', '.join(usable)}", Tone.BAD)


async def _read(
    stand: TestStand, sensor: Kurt2SensorSettings, distance_m: float, findings: Findings
) -> IrReading | None:
    question = OperatorQuestion(
        QuestionKind.BOARD,
        f"The board {distance_m:.2f} m before {sensor.label} ({sensor.name}).",
        (AnswerChoice("", "measure"), AnswerChoice(SKIP, "leave this distance out")),
        subject=sensor.name,
        distance_m=distance_m,
    )
    if await stand.ask(question) == SKIP:
        return None
    await stand.listen(SETTLE_S)
    counts = (await stand.listen(_MEASURE_S)).median(_channel(sensor, findings))
    if counts is None:
        stand.tell(f"{sensor.name} is not heard any more", Tone.BAD)
        return None
    stand.tell(f"{sensor.name} at {distance_m:.2f} m: {counts:.0f} counts", Tone.MEASURED)
    return IrReading(sensor.name, distance_m, counts)


def _rows(readings: list[IrReading], fit: IrFit) -> list[str]:
    return [
        f"{reading.sensor} at {reading.distance_m:.2f} m: {reading.counts:.0f} counts, law {reading.counts - off:.0f}, "
        f"off by {off:+.0f}" + (", left out" if at in fit.outliers else "")
        for at, (reading, off) in enumerate(zip(readings, fit.residuals, strict=True))
    ]


def _channel(sensor: Kurt2SensorSettings, findings: Findings) -> str:
    return findings.channels.get(sensor.name, sensor.channel)
