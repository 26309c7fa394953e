"""Body that turns and bumps at random; `python -m tests.simbridge.turning_run` prints hashes of its states."""

import hashlib
import random
import struct

from simbridge.robot.body import Body
from simbridge.robot.noise import Noise
from simbridge.robot.world import World
from simbridge.worlds.world_loading import load_world
from tests.hal.helpers import ROBOT


def hashes() -> list[str]:
    """Return the hash of all poses and velocities after each 5000 cycles in world A."""
    settings, chance = load_world("a", ROBOT), random.Random(5)
    body = Body(World(settings), ROBOT.geometry, ROBOT.cycle_s, Noise(1, "slip"))
    body.place(settings.start_poses[0].pose)
    digest, found, touched = hashlib.sha256(), [], 0
    for cycle in range(20_000):
        if cycle % 40 == 0:
            speeds = chance.uniform(-0.5, 0.6), chance.uniform(-0.5, 0.6)
        body.move(*speeds)
        touched += body.touching
        digest.update(struct.pack("<6d", *body.pose, *body.velocity))
        if cycle % 5000 == 4999:
            found.append(digest.hexdigest())
    assert touched > 1000
    return found


if __name__ == "__main__":
    print(*hashes())
