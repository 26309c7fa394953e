"""`kurt2rt commission` as a person meets it: typed answers, in real time."""

import signal
from pathlib import Path

import pytest

from config import CONFIG_DIR
from hal.control import Control, RawControl, SpeedControl, decode_control
from hal.shared_bus import SharedBus
from kurt2rt.checks.commission.fault import FaultCode, StepFault
from kurt2rt.checks.commission.progress import load_progress
from tests.checks.commission.typed import PROGRESS, Type, Typed, commission_the_rest, earlier, live, typing
from tests.checks.commission.workshop import BASE, Workshop
from tests.cli.helpers import CommandLine, running
from tests.patience import PATIENCE_S


@pytest.fixture
def type_at(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], tmp_path: Path) -> Type:
    return typing(monkeypatch, capfd, tmp_path)


def test_a_person_types_and_the_file_is_written(type_at: Type, tmp_path: Path) -> None:
    with Workshop() as workshop, live(workshop):
        commission_the_rest(type_at, workshop.spec, tmp_path, "stop")


def test_ctrl_c_brakes_while_the_wheels_turn(tmp_path: Path) -> None:
    earlier(tmp_path, "stop")
    bus = f"commission-{tmp_path.name}"
    onlooker = SharedBus(bus)
    onlooker.set_id_filter(frozenset({0x01}))
    with Workshop(spec=f"shared:{bus}") as workshop, live(workshop):
        with running("commission", f"shared:{bus}", "--name", "robbie", "--only", "stop", folder=tmp_path) as session:
            for line in ("wheels up", "", ""):
                session.type(line)
            while not forward(next_control(onlooker)):
                pass
            said = session.end(signal.SIGINT)
        last = next_control(onlooker)
        while (message := onlooker.recv(0)) is not None:
            last = decode_control(message.data)
    onlooker.shutdown()
    assert isinstance(last, RawControl)
    assert last.left.brake
    assert last.right.brake
    assert "\nstopped: " in said.out
    assert said.err == ""
    assert "stop" not in load_progress(tmp_path / PROGRESS).steps


def next_control(onlooker: SharedBus) -> Control:
    message = onlooker.recv(PATIENCE_S)
    assert message is not None, "no CONTROL is sent"
    return decode_control(message.data)


def forward(control: Control) -> bool:
    return isinstance(control, SpeedControl) and control.left > 0


def test_the_input_that_ends_leaves_the_rest_for_another_day(type_at: Type) -> None:
    with Workshop() as workshop, live(workshop):
        said = type_at(Typed(), workshop.spec, "--name", "robbie")
    assert said.exit_code == 0
    assert "\nleft; " in said.out
    assert ": identity, modes, wheels, stop, sensors, bumpers, infrared;" in said.out


def test_a_failed_step_is_the_exit_code_and_no_file_is_written(type_at: Type, tmp_path: Path) -> None:
    earlier(tmp_path, "identity")
    with Workshop() as workshop:  # switched off: nothing is heard
        said = type_at(Typed("", ""), workshop.spec, "--name", "robbie")
    assert said.exit_code == 1
    fault = StepFault.of(FaultCode.BUS_SILENT, bit_rate_bit_s=BASE.can.bit_rate_bit_s)
    assert f"identity: {fault.text}" in said.out
    assert ": identity; " in said.out.splitlines()[-1]
    assert not (tmp_path / "var" / "robots").exists()


@pytest.mark.parametrize("in_the_way", ["robbie.json", "robbie.json.new"])
def test_commission_unusable_progress_file_prints_one_line(
    kurt2rt: CommandLine, tmp_path: Path, in_the_way: str
) -> None:
    (tmp_path / PROGRESS).with_name(in_the_way).mkdir(parents=True)
    said = kurt2rt.refused("commission", "virtual:empty", "--name", "robbie", "--skip", "modes")
    assert f"'var/commission/{in_the_way}'" in said


def test_commission_other_bus_needs_a_known_robot(kurt2rt: CommandLine, tmp_path: Path) -> None:
    earlier(tmp_path)
    kept = load_progress(tmp_path / PROGRESS)
    unknown = kept.findings.model_copy(update={"hardware_id": None})
    kept.model_copy(update={"findings": unknown}).save(tmp_path / PROGRESS)
    said = kurt2rt.refused("commission", "shared:desk", "--name", "robbie")
    assert "bus can0" in said
    assert "--name" in said


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (("can7",), "bus 'can7': "),
        (("virtual:x", "--robot-settings", "nope"), "nope: "),
        (("virtual:x", "--name", "robbie", "--robot-settings", "other.yaml"), "--robot-settings kurt2"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_commission_that_cannot_start_prints_one_line(
    kurt2rt: CommandLine, tmp_path: Path, words: tuple[str, ...], why: str
) -> None:
    earlier(tmp_path)
    (tmp_path / "other.yaml").write_text((CONFIG_DIR / "robots" / "kurt2.yaml").read_text())
    assert why in kurt2rt.refused("commission", *words)


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (("can0", "--name", "My Robot"), "a-z, 0-9"),
        (("can0", "--only", "identity,dance"), "identity, lifted, modes, wheels, stop"),
        (("can0", "--skip", "dance"), " dance;"),
        (("can0", "--name", "mine"), "is there already"),
        ((), "Missing argument"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_an_option_that_makes_no_sense_is_named(
    kurt2rt: CommandLine, tmp_path: Path, words: tuple[str, ...], why: str
) -> None:
    mine = tmp_path / "var" / "robots" / "mine.yaml"
    mine.parent.mkdir(parents=True)
    mine.write_text("my own: file")
    assert why in kurt2rt.misused("commission", *words)
    assert mine.read_text() == "my own: file"
