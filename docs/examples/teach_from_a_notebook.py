"""Teach a robot from your own program, for instance from a notebook: answer what it asks, reward what it does well.

Start a robot (kurt2rt run), then this:

    python docs/examples/teach_from_a_notebook.py var/devices/local

It keeps a wall on its left with three rules of thumb; put your own teacher in `what_to_do`.
"""

import argparse
import asyncio
from pathlib import Path

from kurt2rt.channel.state import State
from kurt2rt.teaching import TeacherClient

LEFT_FRONT, LEFT_BACK, FRONT = 0, 1, 10
"""Places in `state.infrared_counts`: s1, s2 and s11 of config/robots/kurt2.yaml. High counts are near."""


def what_to_do(state: State) -> str:
    """Your teacher: the action that is right in what the robot senses now."""
    left, front = state.infrared_counts[LEFT_FRONT], state.infrared_counts[FRONT]
    if front > 250:
        return "spin_right"
    if left < 150:
        return "curve_left"
    return "bear_right" if left > 350 else "forward"


async def teach(folder: Path, lessons: int, host: str | None, port: int | None) -> None:
    """Answer until so many lessons are durable, then drive a little by hand and leave."""
    async with TeacherClient(folder, host, port) as robot:
        hello = await robot.hello()
        print(f"{hello.robot}: {', '.join(hello.actions)}")
        print((await robot.take()).text)
        await robot.resume()
        taught = 0
        async for state in robot.states():
            if state.cause == "unknown":
                answer = await robot.answer(what_to_do(state), of=state.tick)
                print(f"tick {state.tick}: {answer.text}")
                taught += answer.accepted
            if taught >= lessons:
                break
        if state.rla is not None:
            print((await robot.reward(+1, of=state.tick)).text)
        async with robot.driving() as wheel:  # as long as this block lasts, and the robot hears us
            wheel.set(-0.1, -0.1)
            await asyncio.sleep(0.5)
        print(f"link: {robot.link.rtt_ms:.1f} ms round trip, {robot.link.answered:.0%} answered")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="the device's side of a pairing: var/devices/NAME")
    parser.add_argument("--lessons", type=int, default=5)
    parser.add_argument("--host", help="of the robot; default: as noted in the pairing")
    parser.add_argument("--port", type=int)
    given = parser.parse_args()
    asyncio.run(teach(given.folder, given.lessons, given.host, given.port))
