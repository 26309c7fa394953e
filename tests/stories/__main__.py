"""Stories of many faults at once, each told by a seed: `python -m tests.stories`, or `make stories`.

`python -m tests.stories FILE` drives one of a file again. A story in which something breaks is shrunk, and stands in
var/stories as a file of some lines.
"""

import argparse
import asyncio
import os
import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import get_args

from hal.points import Point
from tests.stories.shrink import shrunk
from tests.stories.story import Story, all_kinds, as_text, load_story, story_of
from tests.stories.teller import Told, tell

BROKEN = Path("var/stories")
_MEMORY = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
"""Folder in memory, where a disk is faster than simulated time."""
_TELLS_EVERY = 100
_SECONDS_PER_HOUR, _TICKS_PER_S = 3600.0, 100


@dataclass(frozen=True, slots=True)
class Outcome:
    """Story of a seed, and what came of it."""

    story: Story
    told: Told
    shortest: Story | None
    """Shrunk story, if something broke."""


async def told(story: Story) -> Told:
    """Drive a story in a folder of its own."""
    with TemporaryDirectory(dir=_MEMORY) as folder:
        try:
            return await tell(story, Path(folder))
        except Exception as error:  # noqa: BLE001  # of whatever part: it is what broke
            return Told(problems=[f"the story ended by {error!r}"])


async def first_problem(story: Story) -> str:
    """Return the first thing that breaks in a story; empty if everything holds."""
    return next(iter((await told(story)).problems), "")


def drive_seed(seed: int, lasts_s: float) -> Outcome:
    """Drive the story of a seed, and shrink it if something breaks."""
    story = story_of(seed, lasts_s)
    came = asyncio.run(told(story))
    return Outcome(story, came, asyncio.run(shrunk(story, first_problem)) if came.problems else None)


def drive_seeds(seeds: Iterable[int], lasts_s: float, processes: int) -> Iterator[Outcome]:
    """Yield what comes of the stories of these seeds, some processes at a time, as each is over."""
    seeds = iter(seeds)
    with ProcessPoolExecutor(processes) as pool:
        waiting = {pool.submit(drive_seed, each, lasts_s) for each in islice(seeds, 2 * processes)}
        while waiting:
            done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
            yield from (each.result() for each in done)
            waiting |= {pool.submit(drive_seed, each, lasts_s) for each in islice(seeds, len(done))}


def drive_file(file: Path) -> int:
    """Drive the story of a file and print what came of it; return the program's exit code."""
    came = asyncio.run(told(load_story(file)))
    print(*(came.problems or ["everything held"]), f"hash {came.hash}", sep="\n")
    return bool(came.problems)


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.stories", description=__doc__)
    parser.add_argument("file", nargs="?", type=Path, help="story to drive again")
    parser.add_argument("--stories", type=int, default=6000, help="how many")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--hours", type=float, default=1.0, help="longest time for all of them")
    parser.add_argument("--seconds", type=float, default=60.0, help="length of a story")
    words = parser.parse_args()
    if words.file is not None:
        return drive_file(words.file)
    begun_s = time.monotonic()
    ends_s = begun_s + words.hours * _SECONDS_PER_HOUR
    seeds = range(words.first, words.first + words.stories)
    in_time = (each for each in seeds if time.monotonic() < ends_s)
    stories = broken = ticks = lessons = starts = 0
    acted, happened, robots = Counter[str](), Counter[str](), Counter[str]()
    for outcome in drive_seeds(in_time, words.seconds, len(os.sched_getaffinity(0))):
        came = outcome.told
        stories += 1
        ticks, lessons, starts = ticks + came.ticks, lessons + came.lessons, starts + came.starts
        acted.update(came.acted)
        happened.update(came.happened)
        robots[outcome.story.robot] += 1
        if outcome.shortest is not None:
            broken += 1
            BROKEN.mkdir(parents=True, exist_ok=True)
            file = BROKEN / f"{outcome.story.seed}.yaml"
            file.write_text(as_text(outcome.shortest), encoding="utf-8")
            print(f"{file}: {came.problems[0]}", flush=True)
        if stories % _TELLS_EVERY == 0:
            print(f"{stories} of {words.stories} stories told", flush=True)
    took_h = (time.monotonic() - begun_s) / _SECONDS_PER_HOUR
    hours = ticks / _TICKS_PER_S / _SECONDS_PER_HOUR
    print(
        f"{stories} stories in {took_h:.2f} h ({stories / took_h:.0f} an hour): {hours:.1f} hours of a robot, "
        f"{starts} starts, {lessons} lessons, {sum(acted.values())} faults; {broken} stories broke"
    )
    print(f"robots: {', '.join(f'{robot} {robots[robot]}' for robot in sorted(robots))}")
    never = [f"{target} {kind}" for target, kind in all_kinds() if not acted[f"{target} {kind}"]]
    print(f"never acted: {', '.join(never) or 'none'}")
    print(f"points: {', '.join(f'{point} {happened[point]}' for point in get_args(Point))}")
    return bool(broken)


if __name__ == "__main__":
    sys.exit(main())
