import subprocess
import sys

import pytest

from simbridge.world_settings import load_world
from tests.simbridge.rig import Rig


def hashes(seed: int) -> list[str]:
    """State once a second of a run through world B with curves, collisions and a moved robot."""
    found = []
    with Rig(load_world("b"), seed) as rig:
        for second in range(8):
            rig.drive(25 + 5 * second, 40 - 6 * second, 1.0)
            if second == 5:
                rig.robot.place(load_world("b").start_poses[3].pose)
            found.append(rig.robot.state_hash())
        assert rig.robot.collisions > 0
    return found


@pytest.fixture(scope="module")
def first() -> list[str]:
    return hashes(7)


def test_the_same_seed_gives_the_same_run_to_the_last_bit(first: list[str]) -> None:
    assert first == hashes(7)
    assert len(set(first)) == len(first)


def test_another_seed_gives_another_run(first: list[str]) -> None:
    assert not set(first) & set(hashes(8))


def test_a_fresh_process_gives_the_same_run(first: list[str]) -> None:
    code = "from tests.simbridge.test_same_seed_same_run import hashes; print(*hashes(7))"
    fresh = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert fresh.stdout.split() == first
