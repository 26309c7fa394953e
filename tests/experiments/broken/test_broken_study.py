"""Study of broken sensors: its faults by hand, and a robot in the real simulator."""

from pathlib import Path

import pytest

from hal.robot import SensorReadings
from hal.settings import SettingsError
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.broken.plan import BrokenDrives, BrokenStudy, chosen_sensors, make_plan, read_study
from kurt2rt.experiments.broken.tables import all_tables
from kurt2rt.experiments.lockstep.faulty_sensor import FaultKind, FaultySensor, parse_break
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.plan import run_missing
from kurt2rt.experiments.study.results import Results
from tests.core.test_tick import CorridorRobot
from tests.experiments.helpers import ROBOT, STAGE, teach
from tests.experiments.study.here import HERE

NAMES = ROBOT.infrared.names
PLACE = NAMES.index("s3")
STUCK = {FaultKind.LOW: 70, FaultKind.HIGH: 550, FaultKind.FROZEN: 101}


class ChangingRobot(CorridorRobot):
    """All sensors read another count in each tick."""

    def sense(self, now_s: float) -> SensorReadings:
        self.counts += 1
        return super().sense(now_s)._replace(infrared_counts=(self.counts,) * len(NAMES))


@pytest.mark.parametrize("kind", FaultKind)
def test_faulty_sensor_changes_one_reading_from_its_time_on(kind: FaultKind) -> None:
    robot = ChangingRobot()
    robot.counts = 99
    faulty = FaultySensor(robot, ROBOT.infrared, PLACE, kind, from_s=1.0)
    assert set(faulty.sense(0.9).infrared_counts) == {100}
    found = []
    for tick in range(200):
        counts = faulty.sense(1.0 + tick / 100).infrared_counts
        assert {*counts[:PLACE], *counts[PLACE + 1 :]} == {faulty.true_counts}
        assert counts[PLACE] == faulty.counts
        found.append(counts[PLACE])
    if kind in STUCK:
        assert set(found) == {STUCK[kind]}
    elif kind is FaultKind.UNPLUGGED:
        assert set(found) == {0, 1, 2, 3}
    else:
        mean = 70 if kind is FaultKind.DARK else 550
        assert abs(sum(found) / len(found) - mean) < 5
        assert len(set(found)) > 5


def test_chosen_sensors_are_all_or_those_named() -> None:
    assert chosen_sensors(NAMES, None) == tuple(range(18))
    assert chosen_sensors(NAMES, ["s3", "s3", "s1"]) == (PLACE, NAMES.index("s1"))
    with pytest.raises(SettingsError, match="s99"):
        chosen_sensors(NAMES, ["s99"])


def test_break_is_read_from_sensor_and_fault() -> None:
    assert parse_break("s3=low", ROBOT.infrared) == (PLACE, FaultKind.LOW)
    for wrong in ("s3", "s3=dull", "s99=low", ""):
        with pytest.raises(SettingsError, match="s15=low"):
            parse_break(wrong, ROBOT.infrared)


@pytest.fixture(scope="module")
def taught(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, TaskSettings]:
    """Return the folder with one taught robot, and its task."""
    folder = tmp_path_factory.mktemp("taught")
    return folder, teach(folder / "wall_following-1.knowledge").task


@pytest.fixture(scope="module")
def study(taught: tuple[Path, TaskSettings], tmp_path_factory: pytest.TempPathFactory) -> BrokenStudy:
    folder, task = taught
    results = Results(tmp_path_factory.mktemp("broken"))
    drives = BrokenDrives(
        taught=folder,
        seeds=(1,),
        worlds=("a",),
        healthy_worlds=("rooms-SEED",),
        sensors=(PLACE,),
        faults=(FaultKind.UNPLUGGED, FaultKind.LOW),
        longest_s=6.0,
        after_s=1.0,
        healthy_s=2.0,
    )
    plan = make_plan(task, drives, JobParts(factory=STAGE, robot=ROBOT, results=results))
    with results.held():
        run_missing(plan, results, HERE, lambda _: None)
        assert results.missing([*plan.sensor_jobs, *plan.healthy_jobs]) == []
    return read_study(plan, results)


def test_study_measures_how_soon_a_fault_is_noticed(study: BrokenStudy) -> None:
    (outcome,) = study.sensors
    unplugged, low = outcome.drives
    assert (outcome.sensor, outcome.world) == ("s3", "a")
    assert unplugged.noticed == "out of range"
    assert 0.4 < unplugged.driven_s < 0.7
    assert unplugged.after_s == pytest.approx(1.0, abs=0.02)
    assert low.noticed in {"stuck", "sees nothing"}
    assert 0.85 < low.driven_s < 4.2
    assert unplugged.wrong == low.wrong == ()


def test_study_drives_with_working_sensors_too(study: BrokenStudy) -> None:
    assert [(each.world, each.driver, each.named) for each in study.healthy] == [
        ("rooms-1", "RLAs", ()),
        ("rooms-1", "presses", ()),
    ]
    assert all(0.2 < each.driven_s <= 2.0 for each in study.healthy)


def test_tables_have_a_row_for_each_fault_and_for_all(study: BrokenStudy) -> None:
    noticed, collisions, sensors, healthy = all_tables(study)
    assert [row[0] for row in noticed.rows] == [row[0] for row in collisions.rows] == ["unplugged", "low", "all"]
    assert [row[1].split(" (")[0] for row in noticed.rows] == ["1 of 1", "1 of 1", "2 of 2"]
    assert sensors.rows[0][:3] == ("s3", "1 of 1", "1 of 1")
    assert {row[0] for row in healthy.rows} == {"RLAs", "presses"}
