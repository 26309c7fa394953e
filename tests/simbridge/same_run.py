"""Run to be compared; `python -m tests.simbridge.same_run` prints its hashes."""

from simbridge.worlds.world_loading import load_world
from tests.simbridge.rig import Rig


def hashes() -> list[str]:
    """Return the state hash of each second of a run through world B with collisions and a moved robot."""
    found = []
    with Rig(load_world("b"), seed=7) as rig:
        for second in range(8):
            rig.drive(25 + 5 * second, 40 - 6 * second, 1.0)
            if second == 5:
                rig.robot.place(load_world("b").start_poses[3].pose)
            found.append(rig.robot.state_hash())
        assert rig.robot.collisions > 0
    return found


if __name__ == "__main__":
    print(*hashes())
