"""A soak in which everything fails: nothing is lost, grows or drives on."""

import gc
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from statistics import median

import pytest

from kurt2rt.platform.memory import pin_mmap_threshold
from tests.faults.soak import Soak
from tests.faults.table import CASES

MOST_WAITING = 64
"""Commands in the inbox of a tick."""
MOST_GROWN_MB = 5.0


@pytest.fixture
def collected() -> Iterator[None]:
    """Let the garbage of each program be collected, as after its end: what is frozen (tests/conftest.py) stays."""
    gc.unfreeze()
    yield
    gc.freeze()


async def soaked(folder: Path, minutes: float, *, seed: int, lives_s: tuple[float, float], fault_gap_s: float) -> Soak:
    soak = Soak(folder, seed, lives_s=lives_s, fault_gap_s=fault_gap_s)
    with closing(soak.rig):
        await soak.run(minutes)
    return soak


async def test_most_of_a_minute_in_which_something_fails_all_the_while(tmp_path: Path) -> None:
    soak = await soaked(tmp_path, 0.75, seed=1, lives_s=(12.0, 16.0), fault_gap_s=0.5)
    assert soak.complaints == []
    assert soak.most_waiting <= MOST_WAITING
    assert soak.starts >= 3
    assert len(list((tmp_path / "runs").iterdir())) == soak.starts
    assert len(soak.tried) >= 6
    assert any(drove for _, drove in soak.tried)
    assert soak.lessons > 10


@pytest.mark.deep
async def test_the_same_seed_is_the_same_soak(tmp_path: Path) -> None:
    soaks = []
    for name in ("one", "other"):
        (tmp_path / name).mkdir()
        soaks.append(await soaked(tmp_path / name, 0.4, seed=4, lives_s=(8.0, 12.0), fault_gap_s=1.0))
    one, other = ((each.ticks, each.starts, each.lessons, each.tried, each.witness.envelope.frames) for each in soaks)
    assert one == other


@pytest.mark.deep
@pytest.mark.timeout(3600)
async def test_every_case_at_some_time(tmp_path: Path) -> None:
    """Each of the 84, while the robot does something else each time."""
    soak = await soaked(tmp_path, 15.0, seed=5, lives_s=(60.0, 300.0), fault_gap_s=2.0)
    assert soak.complaints == []
    assert {case for case, _ in soak.tried} == set(CASES)


@pytest.mark.deep
@pytest.mark.timeout(3600)
@pytest.mark.usefixtures("collected")
async def test_an_hour_in_which_something_fails_each_minute(tmp_path: Path) -> None:
    pin_mmap_threshold()  # as the robot's program does
    soak = await soaked(tmp_path, 60.0, seed=2, lives_s=(300.0, 900.0), fault_gap_s=50.0)
    assert soak.complaints == []
    assert soak.most_waiting <= MOST_WAITING
    assert sum(drove for _, drove in soak.tried) > 20
    early, late = soak.minutes[10:20], soak.minutes[-10:]
    assert median(each.resident_mb for each in late) - median(each.resident_mb for each in early) <= MOST_GROWN_MB
    # At the full minute something may be open that is not for long.
    assert min(each.open_files for each in late) <= min(each.open_files for each in early)
    assert min(each.threads for each in late) <= min(each.threads for each in early)
