"""Step that finds the analog channel of each distance sensor."""

from collections.abc import Mapping, Sequence

from hal.kurt2_settings import Kurt2SensorSettings
from kurt2rt.checks.commission.fault import FaultCode
from kurt2rt.checks.commission.operator import SKIP, AnswerChoice, OperatorQuestion, QuestionKind, Tone
from kurt2rt.checks.commission.progress import Findings
from kurt2rt.checks.commission.step import StepResult
from kurt2rt.checks.commission.test_stand import TestStand

SETTLE_S = 0.15
"""Time for a new reading; a sensor measures every 38 ms."""
_BASELINE_S = 1.0
_HAND_S = 0.6
_LEAST_RISE = 60.0
"""Counts; a hand at 0.2 m adds about 220 to an empty room, and 100 to a wall at 0.3 m."""
_CLEARLY = 1.7
"""Required ratio of the two largest rises."""
_ALL = "a"


class SensorsStep:
    """Step in which the counts of the sensor behind the operator's hand rise."""

    name = "sensors"
    title = "Each distance sensor's channel"
    why = "A sensor on the wrong channel makes the robot see a wall where there is none. Ten of the channels are known."
    what_to_do = (
        "Clear a metre around the robot, then hold a flat hand 10 to 20 cm before one sensor after the other, "
        "as you are asked. Hold it still for a second after Enter."
    )
    moves = False
    blocks_driving = False

    async def run(self, stand: TestStand, findings: Findings) -> StepResult:
        """Ask the operator for a hand in front of each sensor; return the found channels and the faults.

        Raises AbortedError if the operator leaves, BusError.
        """
        sensors = stand.settings.infrared.sensors
        found = await _kept(stand, findings, sensors)
        await stand.ask(
            OperatorQuestion(QuestionKind.CLEAR, "Step back: nothing within a metre.", (AnswerChoice("", "measure"),))
        )
        await stand.listen(SETTLE_S)
        heard = await stand.listen(_BASELINE_S)
        if not heard.channels:
            result = StepResult(stand, findings)
            result.fail(FaultCode.CHANNELS_SILENT)
            return result
        empty = {channel: heard.median(channel) or 0.0 for channel in heard.channels}
        dead: list[str] = []
        waiting = [sensor for sensor in sensors if sensor.name not in found]
        while waiting:
            sensor = waiting.pop(0)
            channel = await _find(stand, sensor, empty, dead)
            owner = next((name for name, its in found.items() if its == channel), None)
            if owner is not None:  # one of the two hands was at the wrong sensor
                stand.tell(f"That was {owner}'s before: {owner} is asked for again.", Tone.BAD)
                del found[owner]
                waiting += [each for each in sensors if each.name == owner]
            if channel is not None:
                found[sensor.name] = channel
        result = StepResult(stand, findings.model_copy(update={"channels": found, "dead_sensors": tuple(dead)}))
        for sensor in sensors:
            result.note(_row(sensor, found, dead))
        not_tried = [sensor.name for sensor in sensors if sensor.name not in (*found, *dead)]
        if not_tried:
            result.fail(FaultCode.SENSORS_NOT_TRIED, sensors=", ".join(not_tried))
        for name in dead:
            result.fail(FaultCode.SENSOR_DEAD, sensor=name)
        return result


async def _kept(stand: TestStand, findings: Findings, sensors: Sequence[Kurt2SensorSettings]) -> dict[str, str]:
    """Return the channels found before that need no repetition."""
    before = dict(findings.channels)
    missing = [sensor.name for sensor in sensors if sensor.name not in before]
    if not before or not missing:
        return {}
    question = OperatorQuestion(
        QuestionKind.KEEP,
        f"{len(before)} channels were found before.",
        (AnswerChoice("", f"go on with {', '.join(missing)}"), AnswerChoice(_ALL, "ask for all of them again")),
    )
    return {} if await stand.ask(question) == _ALL else before


async def _find(
    stand: TestStand, sensor: Kurt2SensorSettings, empty: Mapping[str, float], dead: list[str]
) -> str | None:
    """Ask until a channel answers or the sensor is given up; return the channel."""
    tried = False
    while True:
        question = OperatorQuestion(
            QuestionKind.HAND,
            f"Your hand 10 to 20 cm before: {sensor.label} ({sensor.name}).",
            (AnswerChoice("", "measure"), AnswerChoice(SKIP, "give this one up" if tried else "skip this one")),
            subject=sensor.name,
        )
        if await stand.ask(question) == SKIP:
            if tried:
                dead.append(sensor.name)
            return None
        await stand.listen(SETTLE_S)
        heard = await stand.listen(_HAND_S)
        rises = sorted(
            ((channel, (heard.median(channel) or 0.0) - counts) for channel, counts in empty.items()),
            key=lambda each: -each[1],
        )
        tried = True
        if not rises or rises[0][1] < _LEAST_RISE:
            stand.tell("No channel answered. Nearer, flat, straight before the sensor?", Tone.BAD)
            continue
        channel, rise = rises[0]
        if len(rises) > 1 and rise < _CLEARLY * rises[1][1]:
            stand.tell(f"{channel} and {rises[1][0]} both answered: take your hand away from the neighbours", Tone.BAD)
            continue
        stand.tell(f"{_format_channel(sensor, channel)}, {rise:+.0f} counts", Tone.MEASURED)
        return channel


def _format_channel(sensor: Kurt2SensorSettings, channel: str) -> str:
    if channel == sensor.channel:
        return f"{sensor.name} {sensor.label}: {channel}, as the table says"
    return f"{sensor.name} {sensor.label}: {channel}, the table says {sensor.channel}"


def _row(sensor: Kurt2SensorSettings, found: Mapping[str, str], dead: list[str]) -> str:
    if sensor.name in found:
        return _format_channel(sensor, found[sensor.name])
    if sensor.name in dead:
        return f"{sensor.name} {sensor.label}: no channel answers"
    return f"{sensor.name} {sensor.label}: not tried, the table says {sensor.channel}"
