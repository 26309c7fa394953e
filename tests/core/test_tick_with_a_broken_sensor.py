"""The tick with a broken infra-red sensor: it stops, says so, and goes on by the neighbours after a resume."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest

from hal.robot_settings import load_robot
from hal.sensor_ring import SubstituteReadings
from hal.sensor_signs import SensorFault
from kurt2rt.core.decision.decision import DecisionCause, StandReason
from kurt2rt.core.decision.standing import ActiveStop, StopReason
from kurt2rt.core.teaching.commands import Resume, Teach, Watch
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.faulty_sensor import FaultKind, FaultySensor
from kurt2rt.runs.explain.collect import collect_facts
from kurt2rt.runs.explain.facts import DecisionFacts
from kurt2rt.runs.explain.reasons import format_reasons
from kurt2rt.runs.replay.comparison import compare
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.runs.replay.replay import Replay
from kurt2rt.runs.replay.run import Run
from tests.runs.replay.stored_runs import replay_until
from tests.runs.replay.stories import NAME, Scene, record_story

SENSOR = 14
TITLE = "front left edge (s15)"
STUCK_FROM_S = 1.0
SECONDS = 9


def spins_with_a_teacher(scene: Scene, record: TickRecord) -> None:
    """Turn on the spot; the teacher answers each question so, and says Go 1 s after each stop."""
    tick, inbox = record.tick, scene.runtime.inbox
    inbox.put(Watch(NAME, tick))
    if record.decision.cause is DecisionCause.UNKNOWN and tick % 20 == 0:
        inbox.put(Teach(f"t{tick}", NAME, "spin_left"))
    scene.presses = scene.presses + 1 if record.standing.stop is not None else 0
    if scene.presses == 100:
        inbox.put(Resume(f"go{tick}", NAME, seen_tick=tick))


class Replayed(NamedTuple):
    """Ticks of the run, in a few groups."""

    run: Run
    before: list[TickRecord]
    stopped: list[TickRecord]
    after: list[TickRecord]


@pytest.fixture(scope="module")
def replayed(tmp_path_factory: pytest.TempPathFactory) -> Replayed:
    """Record a run with a stuck sensor and replay it; every tick must be equal."""
    run = read_run(
        record_story(
            "walls",
            tmp_path_factory.mktemp("run"),
            seconds=SECONDS,
            other=spins_with_a_teacher,
            faulty=lambda robot: FaultySensor(robot, load_robot().infrared, SENSOR, FaultKind.FROZEN, STUCK_FROM_S),
        )
    )
    found = Replayed(run, [], [], [])
    for record in _equal_ticks(run):
        stop = record.standing.stop
        if stop is not None and stop.reason is StopReason.SENSOR_BROKEN:
            found.stopped.append(record)
        else:
            (found.after if record.broken_sensors else found.before).append(record)
    return found


def _equal_ticks(run: Run) -> Iterator[TickRecord]:
    for entry, record in Replay(run):
        assert list(compare(entry, record)) == []
        yield record


def test_broken_sensor_stops_the_robot_until_a_resume(replayed: Replayed) -> None:
    first = replayed.stopped[0]
    assert STUCK_FROM_S + 4 < first.now_s < STUCK_FROM_S + 6
    assert first.standing.reason is StandReason.STOPPED
    assert first.standing.stop == ActiveStop(StopReason.SENSOR_BROKEN, TITLE)
    assert {record.decision.cause for record in replayed.stopped} == {DecisionCause.STOPPED}
    assert len(replayed.stopped) >= 100
    assert any(record.decision.driving for record in replayed.after)


def test_broken_sensor_is_told_in_each_record(replayed: Replayed) -> None:
    assert all(record.broken_sensors == () for record in replayed.before)
    for record in (*replayed.stopped, *replayed.after):
        (sensor,) = record.broken_sensors
        assert (sensor.place, sensor.title, sensor.fault) == (SENSOR, TITLE, SensorFault.STUCK)


def test_broken_sensor_reads_as_its_neighbours(replayed: Replayed) -> None:
    substitute = SubstituteReadings(load_robot().infrared)
    for record in replayed.after:
        counts = record.readings.infrared_counts
        assert counts[SENSOR] == replayed.stopped[0].readings.infrared_counts[SENSOR]
        assert record.trusted_counts == substitute(counts, (SENSOR,))
        assert record.situation.vector[SENSOR] == record.trusted_counts[SENSOR]


def test_why_names_the_broken_sensor(replayed: Replayed) -> None:
    facts = _facts_at(replayed, replayed.after[-1].now_s)
    assert facts.broken_sensors == (TITLE,)
    assert facts.infrared_counts == replayed.after[-1].trusted_counts
    assert any(TITLE in line for line in format_reasons(facts))
    assert _facts_at(replayed, replayed.before[-1].now_s).broken_sensors == ()


def _facts_at(replayed: Replayed, now_s: float) -> DecisionFacts:
    runtime, last = replay_until(replayed.run, now_s)
    return collect_facts(runtime, last.record, lambda _: "")


def test_noisy_phantom_stops_the_robot_and_replays(tmp_path: Path) -> None:
    infrared = load_robot().infrared
    run = read_run(
        record_story(
            "walls",
            tmp_path,
            seconds=5,
            other=spins_with_a_teacher,
            faulty=lambda robot: FaultySensor(robot, infrared, SENSOR, FaultKind.PHANTOM, STUCK_FROM_S),
        )
    )
    stopped = next(record for record in _equal_ticks(run) if record.broken_sensors)
    (sensor,) = stopped.broken_sensors
    assert (sensor.place, sensor.fault) == (SENSOR, SensorFault.SEES_A_PHANTOM)
    assert stopped.standing.stop == ActiveStop(StopReason.SENSOR_BROKEN, TITLE)
