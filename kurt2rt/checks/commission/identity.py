"""Step that checks the controller's identity and the periods of all frames."""

from hal.bus import CONTROL_ID
from hal.codec import hardware, load_codec
from kurt2rt.checks.commission.fault import FaultCode
from kurt2rt.checks.commission.listener import FrameStatistics
from kurt2rt.checks.commission.progress import Findings
from kurt2rt.checks.commission.step import StepResult
from kurt2rt.checks.commission.test_stand import TestStand

_LISTEN_S = 2.0
_PERIOD_TOLERANCE = 0.2


class IdentityStep:
    """Step that listens to the bus for 2 s: reads the controller's identity, judges its frames."""

    name = "identity"
    title = "Who is on the bus?"
    why = "The controller names itself in INFO_1. Frames that are missing, slow or junk would stop the robot later."
    what_to_do = f"Switch the robot on; end every other program that sends on this bus. {_LISTEN_S:.0f} s of listening."
    moves = False
    blocks_driving = True

    async def run(self, stand: TestStand, findings: Findings) -> StepResult:
        """Listen to the CAN bus for 2 s; judge the controller's identity, the frames' periods, and junk.

        Periods are compared with `cycle_s` of the settings. Returns the findings with hardware id and firmware from
        INFO_1, and the faults. Silence is a fault and raises nothing; a lost bus raises BusError.
        """
        heard = await stand.listen(_LISTEN_S)
        result = StepResult(stand, findings)
        if not heard.arrivals_s:
            result.fail(FaultCode.BUS_SILENT, bit_rate_bit_s=stand.settings.can.bit_rate_bit_s)
            for junk, count in heard.junk.items():
                result.fail(FaultCode.BUS_JUNK, junk=junk, count=count)
            return result
        _judge_identity(heard, result)
        _judge_periods(stand, heard, result)
        _judge_junk(heard, result)
        return result


def _judge_identity(heard: FrameStatistics, result: StepResult) -> None:
    for name, said in sorted(heard.identities.items()):
        last = said[-1]
        counted = last.loop_counter - said[0].loop_counter
        result.note(
            f"{name}: {hardware(last.hardware_id)}, firmware {last.firmware}, loop counter at {last.loop_counter}"
        )
        kinds = sorted({each.hardware_id for each in said})
        if len(kinds) > 1:
            result.fail(FaultCode.TWO_ROBOTS, message=name, robots=" and ".join(map(hardware, kinds)))
        elif len(said) > 1 and counted <= 0:
            result.fail(FaultCode.CONTROLLER_HANGS, message=name)
        if name == "INFO_1":
            result.findings = result.findings.model_copy(
                update={"hardware_id": last.hardware_id, "firmware": last.firmware}
            )
    if "INFO_1" not in heard.identities:
        result.fail(FaultCode.IDENTITY_MISSING)


def _judge_periods(stand: TestStand, heard: FrameStatistics, result: StepResult) -> None:
    robot = stand.settings
    codec = load_codec(robot.can.database)
    sensor_of = {sensor.channel: sensor.name for sensor in robot.infrared.sensors}
    periods_ms: dict[int, list[str]] = {}
    for frame_id, message in sorted(codec.by_id.items()):
        sensors = [sensor_of[signal] for signal in message.signals if signal in sensor_of]
        needed = bool(sensors) or message.name == "ENCODER" or (message.name == "BUMPERC" and bool(robot.bumpers))
        period_s = heard.period_s(frame_id)
        frame = f"{message.name} (0x{frame_id:02X})" + (f" with {', '.join(sensors)}" if sensors else "")
        if period_s is not None:
            periods_ms.setdefault(round(period_s * 1000), []).append(message.name)
        if not needed:
            continue
        if period_s is None:
            second = frame_id >= _SECOND_CONTROLLER
            result.fail(FaultCode.FRAME_MISSING_SECOND if second else FaultCode.FRAME_MISSING, frame=frame)
        elif abs(period_s / robot.cycle_s - 1.0) > _PERIOD_TOLERANCE:
            result.fail(
                FaultCode.FRAME_PERIOD, frame=frame, period_ms=period_s * 1000, expected_ms=robot.cycle_s * 1000
            )
    for period_ms, names in sorted(periods_ms.items()):
        result.note(f"every {period_ms} ms: {', '.join(names)}")
    strange = sorted(each for each in heard.arrivals_s if each not in codec.by_id and each != CONTROL_ID)
    if strange:
        result.note("not in the CAN database, ignored: " + ", ".join(f"0x{each:X}" for each in strange))


def _judge_junk(heard: FrameStatistics, result: StepResult) -> None:
    for junk, count in sorted(heard.junk.items()):
        result.fail(FaultCode.JUNK, junk=junk, count=count)
    if heard.control:
        result.fail(FaultCode.FOREIGN_CONTROL, count=heard.control)


_SECOND_CONTROLLER = 0x14
