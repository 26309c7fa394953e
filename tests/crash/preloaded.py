"""What all programs of stories share: imported once, in the process that they are forked from."""

import gc
import importlib

from hal.codec import load_codec
from hal.robot_settings import load_robot
from kurt2rt.tasks.settings import load_task

_MODULES = (
    "aiocoap.oscore",
    "aiocoap.transports.udp6",
    "anyio._backends._asyncio",
    "anyio.streams.tls",
    "kurt2rt.cli.main",
    "kurt2rt.cli.run",
    "kurt2rt.cli.sim",
    "kurt2rt.cli.sim_desk",
    "kurt2rt.experiments.courses.laps",
    "kurt2rt.service",
    "kurt2rt.simulated_ground",
    "multiprocessing.spawn",
    "numpy.ma",
    "rich._emoji_codes",
    "simbridge.standalone",
    "tests.crash.kill_story",  # each program looks into the one that started it
    "typer._adapters",
)
for _name in _MODULES:
    importlib.import_module(_name)
load_codec()  # and remembers it
load_robot()
load_task("wall_following")  # with the code of its judges
# A collection in a program would write into all that it shares with the others, and so copy it.
gc.collect()
gc.freeze()
