"""Step that checks the controller's identity and the periods of all frames."""

from hal.bus import CONTROL_ID
from hal.codec import load_codec
from hal.identity import hardware
from kurt2rt.checks.commission.findings import Findings
from kurt2rt.checks.commission.frame_statistics import FrameStatistics
from kurt2rt.checks.commission.step import StepResult
from kurt2rt.checks.commission.test_stand import TestStand

_LISTEN_S = 2.0
_PERIOD_TOLERANCE = 0.2


class IdentityStep:
    """Step that listens and sends nothing."""

    name = "identity"
    title = "Who is on the bus?"
    why = "The controller names itself in INFO_1. Frames that are missing, slow or junk would stop the robot later."
    what_to_do = f"Switch the robot on; end every other program that sends on this bus. {_LISTEN_S:.0f} s of listening."
    moves = False
    blocks_driving = True

    async def run(self, stand: TestStand, findings: Findings) -> StepResult:
        """Listen to the CAN bus for 2 s; judge the controller's identity, the frames' periods, and junk.

        Periods are compared with `can.cycle_s` of the settings. Returns the findings with hardware id and firmware from
        INFO_1, and an instruction for each fault. Silence is a fault and raises nothing.
        """
        heard = await stand.listen(_LISTEN_S)
        result = StepResult(findings)
        if not heard.arrivals_s:
            result.to_do.append(
                "Nothing was heard: is the robot on, the cable in, the interface up at "
                f"{stand.settings.can.bit_rate_bit_s} bit/s, the bus terminated at both ends?"
            )
            result.to_do += [f"{what}: {count} of them; check the bit rate" for what, count in heard.junk.items()]
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
            result.to_do.append(
                f"{name} comes from {' and '.join(map(hardware, kinds))}: two robots; take one off the bus"
            )
        elif len(said) > 1 and counted <= 0:
            result.to_do.append(f"{name}'s loop counter does not advance: the controller hangs; switch it off and on")
        if name == "INFO_1":
            result.findings = result.findings.model_copy(
                update={"hardware_id": last.hardware_id, "firmware": last.firmware}
            )
    if "INFO_1" not in heard.identities:
        result.to_do.append("INFO_1 (0x04) never came: this is not the KURT2 controller, or it has not started")


def _judge_periods(stand: TestStand, heard: FrameStatistics, result: StepResult) -> None:
    robot = stand.settings
    codec = load_codec(robot.can.database)
    sensor_of = {sensor.channel: sensor.name for sensor in robot.infrared.sensors}
    periods_ms: dict[int, list[str]] = {}
    for frame_id, message in sorted(codec.by_id.items()):
        sensors = [sensor_of[signal] for signal in message.signals if signal in sensor_of]
        needed = bool(sensors) or message.name == "ENCODER" or (message.name == "BUMPERC" and bool(robot.bumpers))
        period_s = heard.period_s(frame_id)
        who = f"{message.name} (0x{frame_id:02X})" + (f" with {', '.join(sensors)}" if sensors else "")
        if period_s is not None:
            periods_ms.setdefault(round(period_s * 1000), []).append(message.name)
        if not needed:
            continue
        if period_s is None:
            board = " of the second controller" if frame_id >= _SECOND_CONTROLLER else ""
            result.to_do.append(
                f"{who} never came: check the frame's source{board}, or take its sensors out of the table"
            )
        elif abs(period_s / robot.can.cycle_s - 1.0) > _PERIOD_TOLERANCE:
            result.to_do.append(
                f"{who}: every {period_s * 1000:.1f} ms, the settings expect {robot.can.cycle_s * 1000:.0f} ms; "
                "frames are lost (see ip -s link), or can.cycle_s is another on this robot"
            )
    for period_ms, names in sorted(periods_ms.items()):
        result.note(f"every {period_ms} ms: {', '.join(names)}")
    strange = sorted(each for each in heard.arrivals_s if each not in codec.by_id and each != CONTROL_ID)
    if strange:
        result.note("not in the CAN database, ignored: " + ", ".join(f"0x{each:X}" for each in strange))


def _judge_junk(heard: FrameStatistics, result: StepResult) -> None:
    for what, count in sorted(heard.junk.items()):
        result.to_do.append(f"{count} x {what}: find who sends it, or the loose contact")
    if heard.control:
        result.to_do.append(f"{heard.control} CONTROL frames from another program: find that program and end it")


_SECOND_CONTROLLER = 0x14
