"""Steps that the operator's hands do: sensors and bumpers."""

import re
from dataclasses import dataclass
from pathlib import Path

from hal.kurt2_settings import Kurt2Settings
from kurt2rt.checks.commission.checklist import blocking_failures
from kurt2rt.checks.commission.fault import FaultCode, StepFault
from kurt2rt.checks.commission.operator import SKIP, OperatorQuestion, QuestionKind, Tone
from kurt2rt.checks.commission.progress import StepOutcome
from tests.checks.commission.wired_end import Wiring
from tests.checks.commission.workshop import BASE, CODEC, Session, Workshop

# Sensors


async def test_a_dead_sensor_is_given_up_and_told(tmp_path: Path) -> None:
    with Workshop(without("s5")) as workshop:
        session = Session(workshop, tmp_path)
        await session.run("sensors")
    assert session.faults("sensors") == (StepFault.of(FaultCode.SENSOR_DEAD, sensor="s5"),)
    assert session.progress.findings.dead_sensors == ("s5",)
    assert session.person.lines(Tone.BAD)
    assert blocking_failures(session.progress) == []


async def test_no_hand_is_asked_for_while_no_channel_is_heard(tmp_path: Path) -> None:
    boards = [message.frame_id for message in CODEC.by_id.values() if message.name.startswith(("ADC", "BDC"))]
    with Workshop(wiring=Wiring(silent_ids=boards)) as workshop:
        session = Session(workshop, tmp_path)
        session.knows(channels={"s9": "BDC04"})
        await session.run("sensors")
    assert QuestionKind.HAND not in [question.about for question in session.person.asked]
    assert session.faults("sensors") == (StepFault(FaultCode.CHANNELS_SILENT),)
    assert session.progress.findings.channels == {"s9": "BDC04"}


@dataclass
class Clumsy:
    """Holds the hand before another sensor the first time."""

    workshop: Workshop
    asked_for: str
    held_before: str
    erred: bool = False

    def __call__(self, question: OperatorQuestion) -> str | None:
        if question.about is not QuestionKind.HAND:
            return None
        if question.subject == self.asked_for and not self.erred:
            self.erred = True
            self.workshop.hold_before(self.held_before, 0.15)
            return ""
        self.workshop.hold_before(question.subject, 0.15)
        return ""


async def test_sensors_step_hand_at_a_wrong_sensor_is_corrected_later(tmp_path: Path) -> None:
    with Workshop() as workshop:
        session = Session(workshop, tmp_path, Clumsy(workshop, "s1", "s2"))
        await session.run("sensors")
    assert session.progress.findings.channels == {each.name: each.channel for each in BASE.infrared.sensors}
    assert re.findall(r"\bs\d+", session.person.lines(Tone.BAD)[0]) == ["s1", "s1"]


async def test_a_hand_that_covers_two_sensors_names_none_of_them(tmp_path: Path) -> None:
    tried: list[str] = []

    def cover(question: OperatorQuestion) -> str | None:
        if question.about is not QuestionKind.HAND:
            return None
        tried.append(question.subject)
        if question.subject != "s9" or tried.count("s9") > 1:
            return SKIP
        workshop.hold_between("s9", "s11", 0.15)
        return ""

    with Workshop(hand_radius_m=0.14) as workshop:
        session = Session(workshop, tmp_path, cover)
        await session.run("sensors")
    (told, *_) = session.person.lines(Tone.BAD)
    assert session.progress.findings.channels == {}
    assert len(re.findall("[AB]DC..", told)) == 2


def without(sensor: str) -> Kurt2Settings:
    """Return the settings of a robot on which one sensor is not plugged in."""
    sensors = tuple(each for each in BASE.infrared.sensors if each.name != sensor)
    return BASE.model_copy(update={"infrared": BASE.infrared.model_copy(update={"sensors": sensors})})


# Bumpers


async def test_bumpers_on_one_anothers_bits_are_found(tmp_path: Path) -> None:
    with Workshop(wiring=Wiring(bumper_bits={"front left": 3, "rear left": 0})) as workshop:
        session = Session(workshop, tmp_path)
        await session.run("bumpers")
    assert session.progress.findings.bumper_bits == {
        "front left": 3,
        "front centre": 1,
        "front right": 2,
        "rear left": 0,
        "rear centre": 4,
        "rear right": 5,
    }
    assert session.measured("bumpers")[0].startswith("front left: bit 3, ")


async def test_a_bumper_that_hangs_is_named_by_its_bit(tmp_path: Path) -> None:
    with Workshop(wiring=Wiring(hanging_bits=0b100)) as workshop:
        session = Session(workshop, tmp_path)
        await session.run("bumpers")
    assert session.faults("bumpers") == (
        StepFault.of(FaultCode.BUMPER_HANGS, bits="bit 2"),
        StepFault.of(FaultCode.BUMPER_NOT_FOUND, bumper="front right"),
    )


async def test_two_bumpers_that_answer_together_are_asked_for_again(tmp_path: Path) -> None:
    with Workshop(wiring=Wiring(bumper_bits={"front left": 1})) as workshop:
        session = Session(workshop, tmp_path)
        await session.run("bumpers")
    told, _ = session.person.lines(Tone.BAD)
    assert re.findall("bit 1|front left|front centre", told) == ["bit 1", "front left", "front centre"]
    assert session.outcome("bumpers") is StepOutcome.FAILED


async def test_a_robot_whose_bumpers_are_not_heard_of_is_told_so(tmp_path: Path) -> None:
    with Workshop(wiring=Wiring(silent_ids=[0x0A])) as workshop:
        session = Session(workshop, tmp_path)
        await session.run("bumpers")
    assert session.faults("bumpers") == (StepFault(FaultCode.BUMPERS_SILENT),)
