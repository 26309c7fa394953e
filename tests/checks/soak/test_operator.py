"""The operator of a soak: repositions a stuck robot, and switches it off and on if that does not help."""

import random
from types import SimpleNamespace
from typing import cast

import pytest

from hal.guard_reason import GuardReason
from hal.robot import STANDSTILL, GuardResult, WheelSpeeds
from kurt2rt.checks.soak.operator import SoakOperator
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.outcome import Outcome, ResultCode
from kurt2rt.core.teaching.commands import CommandResult, Resume
from kurt2rt.core.tick_record import TickRecord
from simbridge.faults.long_run_rig import LongRunRig
from tests.checks.soak.helpers import CYCLE_S

AHEAD = WheelSpeeds(0.3, 0.3)
PATIENCE_S = 1.5


@pytest.fixture(autouse=True)
def driver(rig: LongRunRig) -> None:
    rig.start_driver("none")


def drive(rig: LongRunRig, person: SoakOperator, until_s: float, wanted: WheelSpeeds = AHEAD) -> None:
    """Drive tick by tick, resumed at once after each stop of the guard, while the operator looks on."""
    robot, time = rig.robot, rig.time
    assert robot is not None
    while time.now_s() < until_s:
        time.run_until(time.now_s() + CYCLE_S)
        robot.sense(time.now_s())
        robot.release()
        grant = robot.drive(wanted, time.now_s(), time.now_s())
        person.on_tick(seen(grant))


def seen(grant: GuardResult, *commands: Resume) -> TickRecord:
    """Return a tick in which an RLA would drive and these commands were carried out."""
    results = tuple(CommandResult(each.command_id, Outcome(ResultCode.RESUMED)) for each in commands)
    decision = SimpleNamespace(cause=DecisionCause.RLA)
    return cast(TickRecord, SimpleNamespace(guard_result=grant, decision=decision, commands=commands, results=results))


def test_a_robot_that_makes_its_way_is_left_alone(rig: LongRunRig) -> None:
    person = SoakOperator(rig, PATIENCE_S, CYCLE_S)
    drive(rig, person, 2.5)
    assert (person.set_down, person.switched_on) == (0, 0)


def test_one_that_makes_no_way_is_set_down_elsewhere(rig: LongRunRig) -> None:
    person = SoakOperator(rig, PATIENCE_S, CYCLE_S)
    drive(rig, person, PATIENCE_S + 0.2, WheelSpeeds(0.1, -0.1))
    assert (person.set_down, person.switched_on) == (1, 0)


def test_operator_power_cycles_motors_switched_off_by_noise(rig: LongRunRig, monkeypatch: pytest.MonkeyPatch) -> None:
    """ACTUATOR_OFF (docs/the-robot.md#control-modes) holds through any number of programs."""
    monkeypatch.setattr(random.Random, "randbytes", lambda _, count: b"\xff\x01".ljust(count, b"\0"))
    rig.begin("bus_out", "garbage", begin_s=0.1, end_s=0.2, period_s=1.0, delay_s=1.0)
    person = SoakOperator(rig, PATIENCE_S, CYCLE_S)
    drive(rig, person, 0.3)
    rig.end()
    for until_s in (0.8, 1.3):
        rig.start_driver("none")
        drive(rig, person, until_s)
        assert max(map(abs, rig.simulation.wheel_speeds)) < 0.01
    drive(rig, person, 2 * PATIENCE_S + 0.5)
    assert (person.set_down, person.switched_on) == (2, 1)
    drive(rig, person, 2 * PATIENCE_S + 1.5)
    assert min(rig.simulation.wheel_speeds) > 0.2


def test_operator_leaves_a_latched_robot_to_its_teacher(rig: LongRunRig) -> None:
    person, robot, time = SoakOperator(rig, PATIENCE_S, CYCLE_S), rig.robot, rig.time
    assert robot is not None
    robot.emergency_stop(GuardReason.WHEELS_DISOBEY)
    while time.now_s() < 3 * PATIENCE_S:
        time.run_until(time.now_s() + CYCLE_S)
        robot.sense(time.now_s())
        grant = robot.drive(AHEAD, time.now_s(), time.now_s())
        person.on_tick(seen(grant))
    assert person.set_down == 0


def test_operator_repositions_a_robot_latching_at_each_resume(rig: LongRunRig) -> None:
    person = SoakOperator(rig, PATIENCE_S, CYCLE_S)
    again = GuardResult(STANDSTILL, (GuardReason.WHEELS_DISOBEY,), latched=True)
    go = Resume("go", "Ann")

    def ticks(count: int) -> int:
        return sum(person.on_tick(seen(again)) for _ in range(count))

    patience = round(PATIENCE_S / CYCLE_S)
    assert ticks(2 * patience) == 0, "no teacher has resumed it yet"
    assert not person.on_tick(seen(again, go))
    assert ticks(patience) == 1
    assert ticks(2 * patience) == 0, "it waits where it was set down"
    assert person.set_down == 1
