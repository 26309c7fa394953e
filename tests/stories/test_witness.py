"""The witness would see a program that drives when it must not, and one that loses ticks or lessons."""

import random
from collections.abc import Iterator
from contextlib import closing
from functools import partial
from pathlib import Path

import pytest

from hal.guard_reason import GuardReason
from hal.robot import SensorReadings, WheelSpeeds
from kurt2rt.core import tick
from kurt2rt.core.decision.decision import Decision, DecisionCause, Level
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.teaching.authority import ControlAuthority, StopRecord
from kurt2rt.core.teaching.commands import Drive, Resume, Stop
from tests.stories.device import TEACHER, Device
from tests.stories.program import Program
from tests.stories.rig import CORRIDOR, ROBOT, Rig
from tests.stories.table import TABLE
from tests.stories.witness import StandstillInterval, Witness

AHEAD = WheelSpeeds(0.2, 0.2)


class Careless:
    """A level that always drives; the tick must not let it."""

    def __init__(self, behind: Level) -> None:
        self._behind = behind

    def decide(self, situation: Situation, readings: SensorReadings, stand_because: DecisionCause | None) -> Decision:
        decision = self._behind.decide(situation, readings, stand_because)
        return decision._replace(wheel_speeds=WheelSpeeds(0.1, 0.1), action="forward")


@pytest.fixture
def rig() -> Iterator[Rig]:
    rig = Rig(ROBOT, CORRIDOR, random.Random(1))
    yield rig
    rig.close()


@pytest.fixture
def witness(rig: Rig) -> Witness:
    return Witness(rig)


@pytest.fixture
def program(rig: Rig, witness: Witness, tmp_path: Path) -> Iterator[Program]:
    program = Program(rig, witness, Device(rig.injection, random.Random(1)), tmp_path, 1, random.Random(1))
    with closing(program.knowledge.journal):
        yield program


async def run(program: Program, rig: Rig, until_s: float) -> None:
    await program.run(lambda _: None, lambda: rig.time.now_s() >= until_s)


@pytest.mark.parametrize("stops", [True, False])
async def test_untold_program_with_a_careless_layer_stands_or_is_seen(
    rig: Rig, witness: Witness, program: Program, monkeypatch: pytest.MonkeyPatch, stops: bool
) -> None:
    if not stops:
        monkeypatch.setattr(tick, "stopped", lambda decision, _: decision)
    program.level.inner = Careless(program.level.inner)
    await run(program, rig, 1.0)
    assert (program.ended_by, program.close()) == ("", [])
    if stops:
        assert witness.complaints == []
        assert rig.simulation.wheel_speeds == (0.0, 0.0)
    else:
        assert len(witness.complaints) > 80
        assert "drives though the program was started, without a resume" in witness.complaints[0]


async def test_a_channel_that_forgets_a_stop_is_seen(
    rig: Rig, witness: Witness, program: Program, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(StopRecord, "refusal_since", lambda *_: None)
    monkeypatch.setattr(ControlAuthority, "is_press_over", lambda *_: False)
    drive = Drive(TEACHER, 0, press_id=1, left_m_s=0.1, right_m_s=0.1)
    for at_s, command in ((0.1, drive), (0.2, Stop("1", TEACHER)), (0.3, drive), (0.4, Resume("2", TEACHER, 15))):
        rig.time.at(at_s, partial(program.put, command))
    await run(program, rig, 0.5)
    assert "drives though eve said stop, without a resume" in witness.complaints[0]
    assert "a stop is lifted by a teacher who had not seen it" in witness.complaints[-1]


async def test_a_tick_that_is_not_accounted_for_is_seen(rig: Rig, witness: Witness, program: Program) -> None:
    await run(program, rig, 0.5)
    assert witness.complaints == []
    program.runtime.timer.missed_ticks += 1
    await run(program, rig, 0.6)
    assert "1 missed are not as many" in witness.complaints[0]


async def test_a_lesson_that_is_not_in_the_file_is_missed(rig: Rig, program: Program) -> None:
    await run(program, rig, 0.5)
    program.knowledge.submitted.append("1-999")
    assert "0 and 1 lessons were taught, the file holds 0" in program.close()[0]


async def test_an_error_in_the_loop_ends_the_program_and_says_where(rig: Rig, program: Program) -> None:
    del program.level.inner
    await run(program, rig, 1.0)
    assert program.ended_by.startswith("AttributeError(")
    assert "in level.py, line" in program.ended_by
    rig.time.run_until(1.0)
    assert rig.simulation.wheel_speeds == (0.0, 0.0)


def test_standstills_cover_stop_and_silence(rig: Rig, witness: Witness) -> None:
    witness.begin_program(rig.start_driver())
    witness.watch()
    witness.envelope.on_heard(5, b"", 0.0)
    go, stand = bytes((0, 2, 0, 1, 0, 1, 0, 1)), bytes((0, 2, 0, 0, 0, 0, 0, 1))
    for at_s, payload in ((0.1, go), (0.2, go), (0.3, stand), (0.4, go), (0.9, go), (1.0, b"\xff" * 8), (1.05, go)):
        rig.time.run_until(at_s)
        witness.envelope.on_sent(round(at_s * 100), at_s, payload, 0.0, latched=False)
        rig.ends.on_arrived(round(at_s * 100), payload, at_s)
    # Told so, silent for longer than its own watchdog waits, and silent in the end.
    stands = [(round(each.from_s, 6), each.to_s) for each in witness.standstills(0.0, 2.0)]
    assert stands == [(0.0, 0.1), (0.3, 0.4), (0.6, 0.9), (1.25, 2.0)]
    assert witness.standstills(0.35, 0.5) == [StandstillInterval(0.35, 0.4)]
    assert witness.standstills(0.1, 0.2) == []


def test_each_go_on_a_blocked_bus_sends_two_old_frames_at_most(rig: Rig, witness: Witness) -> None:
    """A late confirmation of an old brake counted as that of a new set point, and 163 of them went out."""
    robot = rig.start_driver()
    witness.begin_program(robot)

    def drive(until_s: float) -> None:
        while rig.time.now_s() < until_s:
            rig.time.run_until(rig.time.now_s() + ROBOT.cycle_s)
            witness.sense(rig.time.now_s())
            witness.drive(AHEAD, rig.time.now_s(), rig.time.now_s())

    drive(1.0)
    rig.injection.plan(TABLE.fault("bus_out", "delayed", 1.0, 9.0))
    for goes, until_s in enumerate((2.0, 3.0, 4.0), 1):
        drive(until_s)
        assert robot.health.latched == GuardReason.BUS_BLOCKED
        assert witness.envelope.old_frames <= 2 * goes
        robot.release()
