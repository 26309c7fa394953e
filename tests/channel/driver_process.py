"""Teacher that drives by hand until this process is ended or stopped, a child of test_links.py.

Arguments: folder of the device, port of the robot.
"""

import sys
from pathlib import Path

import anyio

from kurt2rt.core.teaching.commands import Take
from kurt2rt.teacher import TeacherClient


async def drive(folder: Path, port: int) -> None:
    async with TeacherClient(folder, port=port) as robot:
        await robot.send(Take)
        async with robot.driving() as wheel:
            while True:
                wheel.set((0.2, 0.2))
                await anyio.sleep(0.05)


if __name__ == "__main__":
    anyio.run(drive, Path(sys.argv[1]), int(sys.argv[2]))
