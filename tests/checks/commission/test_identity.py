"""Step identity: nodes on the bus, and frames missing on it."""

import re
from pathlib import Path

import can
import pytest

from hal.bus import open_bus
from hal.codec import load_codec
from hal.control import Mode, SpeedControl, control_frame
from kurt2rt.checks.commission.fault import FaultCode, StepFault
from kurt2rt.checks.commission.operator import OperatorQuestion, QuestionKind
from kurt2rt.checks.commission.progress import StepOutcome
from tests.checks.commission.wired_end import Wiring
from tests.checks.commission.workshop import Session, Workshop

CODEC = load_codec()


def frame_id(name: str) -> int:
    return CODEC.message(name).frame_id


async def listened(tmp_path: Path, wiring: Wiring) -> Session:
    with Workshop(wiring=wiring) as workshop:
        session = Session(workshop, tmp_path)
        await session.run("identity")
    return session


@pytest.mark.parametrize(
    ("name", "fault"),
    [
        ("INFO_1", StepFault(FaultCode.IDENTITY_MISSING)),
        ("ENCODER", StepFault.of(FaultCode.FRAME_MISSING, frame="ENCODER (0x09)")),
        ("BDC04_07", StepFault.of(FaultCode.FRAME_MISSING_SECOND, frame="BDC04_07 (0x16) with s9, s10, s12, s13")),
    ],
)
async def test_a_frame_that_never_comes_is_named(tmp_path: Path, name: str, fault: StepFault) -> None:
    session = await listened(tmp_path, Wiring(silent_ids=[frame_id(name)]))
    assert session.faults("identity") == (fault,)


async def test_a_frame_at_half_its_pace_is_named_with_both_paces(tmp_path: Path) -> None:
    session = await listened(tmp_path, Wiring(every_other=[frame_id("ADC04_07")]))
    (fault,) = session.faults("identity")
    assert (fault.code, fault.fields["frame"]) == (FaultCode.FRAME_PERIOD, "ADC04_07 (0x06) with s16, s11, s15, s1")
    assert (fault.fields["period_ms"], fault.fields["expected_ms"]) == pytest.approx((20.0, 10.0), abs=0.05)


async def test_junk_strangers_and_another_sender_of_control_are_found(tmp_path: Path) -> None:
    with Workshop() as workshop:
        stranger = open_bus(workshop.spec)
        port = stranger.telemetry_port()

        def disturb(question: OperatorQuestion) -> None:
            if question.about is not QuestionKind.BEGIN:
                return
            port.send(can.Message(arbitration_id=0x123, is_extended_id=False, data=b"hello"))
            port.send(can.Message(arbitration_id=0x12345, is_extended_id=True, data=b""))
            port.send(CODEC.message("ADC00_03").pack(4000, 0, 0, 0))
            stranger.control_port().send(control_frame(SpeedControl(Mode.SPEED_CM, 0, 0)))

        session = Session(workshop, tmp_path, disturb)
        await session.run("identity")
        stranger.shutdown()
    assert session.outcome("identity") is StepOutcome.FAILED
    faults = session.faults("identity")
    assert [each.code for each in faults] == [FaultCode.JUNK, FaultCode.JUNK, FaultCode.FOREIGN_CONTROL]
    assert [each.fields["count"] for each in faults] == [1, 1, 1]
    assert str(faults[0].fields["junk"]).startswith("ADC00 ")
    assert any(line.endswith(": 0x123") for line in session.measured("identity"))


async def test_two_robots_on_one_bus_are_found(tmp_path: Path) -> None:
    with Workshop() as workshop:
        other = open_bus(workshop.spec)

        def join(question: OperatorQuestion) -> None:
            if question.about is QuestionKind.BEGIN:
                other.telemetry_port().send(CODEC.message("INFO_1").pack(7, 1, 0))

        session = Session(workshop, tmp_path, join)
        await session.run("identity")
        other.shutdown()
    (fault,) = session.faults("identity")
    assert (fault.code, fault.fields["message"]) == (FaultCode.TWO_ROBOTS, "INFO_1")
    assert re.findall(r"\d+", str(fault.fields["robots"])) == ["7", "21321"]
