"""What the robot programs of a story share: imported once, in the process that they are forked from."""

# Each of them looks into the program that started it.
import multiprocessing.spawn  # noqa: F401

import tests.crash.kill_story  # noqa: F401
from tests.nursery import preload

preload()
