"""A teacher with a command 20 times a second, a child of test_flood.py: until SIGTERM, then it tells how it went.

Arguments: folder of the device, port of the robot.
"""

import asyncio
import json
import signal
import sys
from collections import Counter
from pathlib import Path

import anyio

from kurt2rt.core.teaching.commands import Resume, Reward, Take, Teach
from kurt2rt.teacher import TeacherClient
from kurt2rt.teacher.client.answer import NoAnswerError

_EVERY_S = 0.05
_REWARD_EACH = 20


async def teach(folder: Path, port: int) -> None:
    told: Counter[str] = Counter()
    over = anyio.Event()
    asyncio.get_running_loop().add_signal_handler(signal.SIGTERM, over.set)

    async def say(robot: TeacherClient, number: int) -> None:
        try:
            answer = await (robot.send(Reward, value=1) if number % _REWARD_EACH == 0 else robot.send(Resume))
        except NoAnswerError:
            told["no answer"] += 1
            return
        told[answer.why or "accepted"] += 1

    async with TeacherClient(folder, port=port) as robot:
        await robot.send(Take)
        await robot.send(Teach, action="forward")
        print("teaching", flush=True)
        before = robot._stream.count
        async with anyio.create_task_group() as tasks:
            number = 0
            while not over.is_set():
                number += 1
                tasks.start_soon(say, robot, number)
                with anyio.move_on_after(_EVERY_S):
                    await over.wait()
        pictures = robot._stream.count - before
    print(json.dumps({"told": told, "pictures": pictures}), flush=True)


if __name__ == "__main__":
    anyio.run(teach, Path(sys.argv[1]), int(sys.argv[2]))
