"""Fault injectors: each does exactly as its kind says."""

import random
from collections.abc import Iterator

import can
import pytest

from hal.bus import CONTROL_ID
from hal.frame import Frame
from kurt2rt.checks.faults.envelope import Envelope
from kurt2rt.checks.faults.failing_clock import BrokenClockError, FaultyClock, RigClock
from kurt2rt.checks.faults.observer import Stand, WheelObserver
from simbridge.faults.event_scheduler import EventScheduler
from simbridge.faults.fault_rig import FaultRigFactory, SimulatedFaultRig
from simbridge.faults.frame_link import FaultyLink, IdealLink
from simbridge.faults.motors import FaultyWheels
from simbridge.faults.timed_fault import Kind, TimedFault
from simbridge.faults.tx_link import FaultyTxLink
from tests.checks.faults.helpers import ROBOT, TABLE

BOARD, OTHER = 0x10, 0x20
CYCLES = 40


def fault(kind: Kind, *, period_s: float = 0.05, delay_s: float = 0.025) -> TimedFault:
    """Return a fault from shortly before 0.1 s to shortly before 0.3 s."""
    return TimedFault(kind, 0.095, 0.295, period_s, delay_s)


# Time


def test_event_scheduler_runs_each_callback_at_its_time() -> None:
    time, acted = EventScheduler(), list[tuple[str, float]]()
    time.every(0.01, 0.005, lambda: acted.append(("cycle", round(time.now_s(), 6))))
    time.at(0.02, lambda: acted.append(("once", time.now_s())))
    time.run_until(0.02)
    time.run_until(0.01)
    assert acted == [("cycle", 0.005), ("cycle", 0.015), ("once", 0.02)]
    assert time.now_s() == 0.02


def test_time_passes_inside_of_what_hangs() -> None:
    time, acted = EventScheduler(), list[float]()
    time.every(0.01, 0.0, lambda: acted.append(time.now_s()))
    time.run_until(0.001)
    time.run_until(time.now_s() + 0.1)  # a tick that hangs
    assert len(acted) == 11


# Frames on their way


def sent_through(way: FaultyLink | FaultyTxLink | IdealLink, time: EventScheduler) -> list[tuple[float, int, bytes]]:
    """Send a numbered frame of each identifier in every cycle; return arrivals: (time in s, identifier, data)."""
    arrived: list[tuple[float, int, bytes]] = []

    def arrive(frame: can.Message) -> None:
        arrived.append((round(time.now_s(), 6), frame.arbitration_id, bytes(frame.data)))

    for cycle in range(CYCLES):
        time.run_until(cycle * 0.01)
        for frame_id in (BOARD, OTHER):
            way.carry(Frame(frame_id, bytes([cycle])), arrive)
    time.run_until(1.0)
    return arrived


def telemetry(kind: Kind) -> list[tuple[float, int, bytes]]:
    time = EventScheduler()
    way = FaultyLink(
        fault(kind),
        time,
        random.Random(1),
        {BOARD},
        falsify=lambda frame: [Frame(BOARD, bytes([255 - frame.data[0]]))],
    )
    return sent_through(way, time)


def of_board(arrived: list[tuple[float, int, bytes]]) -> list[tuple[int, int]]:
    """Return cycle of arrival and content of the board's frames."""
    return [(round(at_s / 0.01), data[0]) for at_s, frame_id, data in arrived if frame_id == BOARD]


KINDS: tuple[Kind, ...] = ("off", "stuck", "garbage", "wrong", "slow", "delayed", "intermittent")


@pytest.mark.parametrize("kind", KINDS)
def test_faulty_link_leaves_other_identifiers_alone(kind: Kind) -> None:
    others = [(at_s, data[0]) for at_s, frame_id, data in telemetry(kind) if frame_id == OTHER]
    assert others == [(round(cycle * 0.01, 6), cycle) for cycle in range(CYCLES)]


@pytest.mark.parametrize("kind", KINDS)
def test_before_and_after_it_is_well(kind: Kind) -> None:
    well = [(cycle, cycle) for cycle in range(CYCLES) if not 10 <= cycle < 30]
    assert set(well) <= set(of_board(telemetry(kind)))


def test_off_and_stuck_and_wrong() -> None:
    assert [cycle for cycle, _ in of_board(telemetry("off")) if 10 <= cycle < 30] == []
    assert [data for cycle, data in of_board(telemetry("stuck")) if 10 <= cycle < 30] == [9] * 20
    assert [data for cycle, data in of_board(telemetry("wrong")) if 10 <= cycle < 30] == list(range(245, 225, -1))


def test_garbage_is_as_long_as_the_frame_and_of_chance() -> None:
    garbage = [data for cycle, data in of_board(telemetry("garbage")) if 10 <= cycle < 30]
    assert len(set(garbage)) > 10


def test_slow_lets_one_pass_in_each_period() -> None:
    assert [cycle for cycle, _ in of_board(telemetry("slow")) if 10 <= cycle < 30] == [15, 20, 25]


def test_faulty_link_delayed_frames_keep_their_order() -> None:
    frames = of_board(telemetry("delayed"))
    assert [data for _, data in frames] == list(range(CYCLES))
    late = [cycle - data for cycle, data in frames if 10 <= data < 27]
    assert set(late) <= {2, 3}


def test_intermittent_comes_and_goes() -> None:
    gone = set(range(10, 30)) - {cycle for cycle, _ in of_board(telemetry("intermittent"))}
    assert gone == {10, 11, 12, 13, 14, 20, 21, 22, 23, 24}


# Frames on their way out of the notebook


def out(kind: Kind) -> list[tuple[float, int, bytes]]:
    time = EventScheduler()
    return sent_through(FaultyTxLink(fault(kind), time, random.Random(1)), time)


def test_tx_link_off_raises_and_stuck_sends_all_at_the_end() -> None:
    with pytest.raises(OSError, match="down"):
        out("off")
    at_the_end = [data[0] for at_s, frame_id, data in out("stuck") if frame_id == BOARD and at_s == 0.295]
    assert at_the_end == list(range(10, 30))


def test_a_way_out_that_is_slow_or_late_keeps_the_order() -> None:
    for kind in ("slow", "delayed"):
        assert [data for _, data in of_board(out(kind))] == list(range(CYCLES))
    assert {round(at_s - data[0] * 0.01, 6) for at_s, _, data in out("delayed") if 10 <= data[0] < 27} == {0.025}


def test_a_way_out_that_is_wrong_says_it_under_another_name() -> None:
    assert not {frame_id for at_s, frame_id, _ in out("wrong") if 0.1 <= at_s < 0.3} & {BOARD, OTHER, CONTROL_ID}


# Motors


def wheels(kind: Kind, brake_at: int = 28) -> list[tuple[float, float]]:
    """Return both sides' speeds after each cycle, commanded 0.3 m/s, and to brake from a cycle on."""
    time = EventScheduler()
    wrong = TimedFault(kind, 0.095, 1.0, 1.0, 0.15)
    driven = FaultyWheels(ROBOT)
    driven.disturb("left_motor", wrong, time, random.Random(1))
    speeds = []
    for cycle in range(CYCLES):
        time.run_until(cycle * 0.01)
        target_m_s = 0.3 if cycle < brake_at else 0.0
        driven.turn(target_m_s, target_m_s, cycle >= brake_at, cycle >= brake_at)
        speeds.append((driven.left_m_s, driven.right_m_s))
    return speeds


@pytest.mark.parametrize("kind", KINDS)
def test_the_other_motor_is_sound(kind: Kind) -> None:
    assert [right for _, right in wheels(kind)] == [right for _, right in wheels("off")]
    assert wheels(kind)[9][0] == wheels(kind)[9][1] > 0.1


def test_a_motor_fails_as_its_kind_says() -> None:
    assert 0.0 < wheels("off")[27][0] < wheels("off")[9][0]
    assert wheels("wrong", brake_at=CYCLES)[-1][0] < 0.0
    assert wheels("stuck")[29][0] > wheels("stuck")[27][0] > 0.2
    assert wheels("delayed")[29][0] > 0.2
    assert wheels("slow")[29][0] > 0.2
    assert wheels("slow")[29][1] < 0.25
    told_anything = [left for left, _ in wheels("garbage", brake_at=CYCLES)[10:]]
    assert max(told_anything) - min(told_anything) > 0.1


# Clocks


async def test_a_sound_clock_waits_exactly() -> None:
    time = EventScheduler()
    clock = RigClock(time)
    await clock.wait_until(0.25)
    assert clock.now_s() == time.now_s() == 0.25


@pytest.mark.parametrize(
    ("kind", "woken_at_s"),
    [("stuck", 0.295), ("wrong", 0.225), ("delayed", 0.225), ("slow", 0.3), ("intermittent", 0.195), ("garbage", 0.2)],
)
async def test_a_clock_wakes_the_loop_by_its_own_time(kind: Kind, woken_at_s: float) -> None:
    time = EventScheduler()
    clock = FaultyClock(time, fault(kind))
    await clock.wait_until(0.09)
    assert time.now_s() == 0.09
    await clock.wait_until(0.2)
    assert time.now_s() == pytest.approx(woken_at_s, abs=0.001)


async def test_faulty_clock_off_raises_and_garbage_reads_nan() -> None:
    time = EventScheduler()
    time.run_until(0.15)
    with pytest.raises(BrokenClockError):
        FaultyClock(time, fault("off")).now_s()
    with pytest.raises(BrokenClockError):
        await FaultyClock(time, fault("off")).wait_until(0.2)
    now_s = FaultyClock(time, fault("garbage")).now_s()
    assert now_s != now_s


# The observer


@pytest.fixture
def rig() -> Iterator[SimulatedFaultRig]:
    rig = FaultRigFactory(ROBOT).open("tick", "stuck", begin_s=1.0, end_s=2.0, period_s=1.0, delay_s=1.0, seed=1)
    yield rig
    rig.close()


def test_wheel_observer_standstills_cover_stop_and_silence(rig: SimulatedFaultRig) -> None:
    observer = WheelObserver(rig, Envelope(TABLE.envelope), controller_watchdog_s=0.2)
    go, stand = bytes((0, 2, 0, 1, 0, 1, 0, 1)), bytes((0, 2, 0, 0, 0, 0, 0, 1))
    for at_s, payload in ((0.1, go), (0.2, go), (0.3, stand), (0.4, go), (0.9, go), (1.0, b"\xff" * 8), (1.05, go)):
        rig.time.run_until(at_s)
        observer.envelope.on_sent(round(at_s * 100), at_s, payload, 0.0, latched=False)
        rig.on_control(round(at_s * 100), payload)
    # Told so, silent for longer than its own watchdog waits, and silent in the end.
    stands = [(round(each.from_s, 6), each.to_s) for each in observer.standstills(0.0, 2.0)]
    assert stands == [(0.0, 0.1), (0.3, 0.4), (0.6, 0.9), (1.25, 2.0)]
    assert observer.standstills(0.35, 0.5) == [Stand(0.35, 0.4)]
    assert observer.standstills(0.1, 0.2) == []
