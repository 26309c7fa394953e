"""The settings file that a commissioning writes, and the robot that is driven with it."""

from pathlib import Path

import pytest
import yaml

from config.settings import SettingsError
from hal.bus import open_bus
from hal.kurt2 import Kurt2
from hal.kurt2_settings import Kurt2Settings, SpeedMode, load_kurt2
from hal.robot import WheelSpeeds
from kurt2rt.checks.commission.checklist import STEPS
from kurt2rt.checks.commission.fault import FaultCode, StepFault
from kurt2rt.checks.commission.progress import Findings, LawFound, Progress, StepOutcome, StepRecord
from kurt2rt.checks.commission.robot_file import commissioned_settings, robot_file, write_robot_file
from tests.checks.commission.wired_end import Wiring
from tests.checks.commission.workshop import BASE, TODAY, Session, Workshop, with_channels

LAW = LawFound(
    numerator_counts_m=90.5,
    offset_m=0.0405,
    bias_counts=60.1,
    near_m=0.1,
    far_m=0.58,
    floor_counts=86,
    plateau_counts=584,
)


def progress(findings: Findings, **other: StepRecord) -> Progress:
    steps = {step.name: StepRecord(outcome=StepOutcome.PASSED, at=TODAY, who="anna") for step in STEPS}
    return Progress(name="robbie", base="kurt2", bus="can0", findings=findings, steps={**steps, **other})


async def test_the_file_makes_the_robot_sense_in_order_and_drive(tmp_path: Path) -> None:
    """Two sensors on each other's channels, and firmware without SPEED_CM."""
    true = with_channels(s1="ADC08", s2="ADC07")
    out = tmp_path / "robbie.yaml"
    with Workshop(true, Wiring(modes=[SpeedMode.SPEED, SpeedMode.RAW])) as workshop:
        session = Session(workshop, tmp_path)
        await session.run("modes", "sensors")
        loaded = write_robot_file(out, BASE, session.progress, STEPS)
        assert loaded == load_kurt2(str(out))
        assert [each.channel for each in loaded.infrared.sensors] == [each.channel for each in true.infrared.sensors]

        workshop.hold_before("s1", 0.2)
        kurt2 = Kurt2(loaded, open_bus(workshop.spec))
        for _ in range(100):
            workshop.step()
            now_s = workshop.robot.time_s
            readings = kurt2.sense(now_s)
            kurt2.drive(WheelSpeeds(0.3, 0.3), now_s, now_s)
        assert readings.infrared_counts == workshop.robot.infrared_counts
        assert workshop.robot.wheel_speeds.left_m_s == pytest.approx(0.3, abs=0.01)
        kurt2.close()


def test_robot_file_begins_with_the_record_of_all_steps() -> None:
    findings = Findings(
        speed_mode=SpeedMode.RAW,
        controller_watchdog_s=0.12,
        channels={"s1": "ADC08", "s2": "ADC07"},
        dead_sensors=("s9",),
        bumper_bits={"front left": 1, "front centre": 0},
        law=LAW,
    )
    failed = StepRecord(
        outcome=StepOutcome.FAILED,
        at=TODAY,
        who="anna",
        measured=("s9: no",),
        faults=(StepFault.of(FaultCode.SENSOR_DEAD, sensor="s9"),),
    )
    text = robot_file(BASE, progress(findings, sensors=failed), STEPS)
    lines = text.splitlines()
    assert lines[0].endswith(" not passed")
    place = lines.index("#   failed, 2026-11-21 15:00 UTC, anna")
    assert lines[place + 1] == "#     s9: no"
    assert lines[place + 2].startswith("#   TO DO: s9 ")
    for line in (
        "  speed_mode: RAW",
        "  controller_watchdog_s: 0.12",
        "  metres_per_tick: 0.00001727",
        "  numerator_counts_m: 90.5",
        "  - {name: s1, label: left front, x_m: 0.14, y_m: 0.165, heading_deg: 90.0, channel: ADC08}",
        "- {name: front centre, end: front}",
    ):
        assert line in lines
    assert Kurt2Settings.model_fields.keys() == yaml.safe_load(text).keys()


def test_words_that_mean_something_to_yaml_survive(tmp_path: Path) -> None:
    odd = "left, {front} #1: größer"
    bumper = BASE.bumpers[0].model_copy(update={"name": odd})
    robot = BASE.model_copy(update={"bumpers": (bumper, *BASE.bumpers[1:])})
    loaded = write_robot_file(tmp_path / "robbie.yaml", robot, progress(Findings()), STEPS)
    assert loaded == robot.model_copy(update={"name": "robbie"})


def test_commissioned_settings_channel_taken_twice_is_refused() -> None:
    with pytest.raises(SettingsError, match=r"s2.*ADC08.*s1"):
        commissioned_settings(BASE, "robbie", Findings(channels={"s1": "ADC08"}))


def test_commissioned_settings_bumper_bit_taken_twice_is_refused() -> None:
    with pytest.raises(SettingsError, match="front left 3"):
        commissioned_settings(BASE, "robbie", Findings(bumper_bits={"front left": 3}))
