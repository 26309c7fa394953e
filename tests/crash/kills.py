"""`make kills`: the robot program is killed so many times, in shards that may run on several machines."""

import argparse
import os
import shutil
import sys
import tempfile
import time
import traceback
from collections.abc import Iterator
from pathlib import Path

import anyio

from tests.crash.kill_story import KillStory, Tally
from tests.forked_program import fork_server

OF_A_STORY = 50
"""Kills of programs that teach into one knowledge file."""
AT_ONCE = 4
"""Stories: a program that starts or brakes mostly waits."""
_MEMORY = Path("/dev/shm")


def main() -> None:
    """Kill; tell after each story; of what was lost an assertion speaks, and its folder stays."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=10_000, help="of all shards together")
    parser.add_argument("--shard", default="1/1", metavar="I/N", help="which one this is, such as 1/8")
    parser.add_argument("--at-once", type=int, default=AT_ONCE, help="stories that go on at the same time")
    parser.add_argument("--after", type=int, default=0, metavar="KILLS", help="that were done before, by other seeds")
    arguments = parser.parse_args()
    shard, shards = (int(number) for number in arguments.shard.split("/"))
    if not 1 <= shard <= shards:
        parser.error(f"there is no shard {arguments.shard}")
    before = arguments.after + sum(kills_of_shard(arguments.kills, each, shards) for each in range(1, shard))
    kills = Kills(before, kills_of_shard(arguments.kills, shard, shards))
    with fork_server():
        anyio.run(kills.run, arguments.at_once)
    print(kills.tally)
    print(f"{kills.tally.kills} passed, {kills.failed} failed")
    sys.exit(1 if kills.failed else 0)


def kills_of_shard(kills: int, shard: int, shards: int) -> int:
    """Return the number of kills of a shard; shards count from 1."""
    return kills * shard // shards - kills * (shard - 1) // shards


def stories(first: int, count: int) -> Iterator[tuple[int, int]]:
    """Seeds and kills of so many kills in all; a seed is the number of its first kill, so that no two are the same."""
    for begin in range(first, first + count, OF_A_STORY):
        yield begin, min(OF_A_STORY, first + count - begin)


class Kills:
    """Those of one shard, in stories."""

    def __init__(self, first: int, count: int) -> None:
        """`first`: number of the first kill among all."""
        self.tally = Tally()
        self.failed = 0
        """Stories that did not go as they should."""
        self._count = count
        self._stories = stories(first, count)
        self._memory = _MEMORY if _MEMORY.is_dir() else None
        self._began_s = time.monotonic()

    async def run(self, at_once: int) -> None:
        """So many stories at once, until all are told."""
        async with anyio.create_task_group() as tasks:
            for _ in range(at_once):
                tasks.start_soon(self._one_after_the_other)

    async def _one_after_the_other(self) -> None:
        for seed, kills in self._stories:
            await self._story(seed, kills)

    async def _story(self, seed: int, kills: int) -> None:
        # A kill needs no disk; every second one has it all the same, and waits for it.
        memory = self._memory if seed // OF_A_STORY % 2 else None
        folder = Path(tempfile.mkdtemp(prefix=f"kurt2rt-kills-{seed}-", dir=memory))
        story = KillStory(folder, f"shared:kills-{os.getpid()}-{seed}", seed)
        try:
            await story.run(kills)
        except Exception:  # noqa: BLE001 - the others go on: one that fails in a thousand is to be counted
            self.failed += 1
            print(f"seed {seed}, after kill {story.tally.kills}, in {folder}:\n{traceback.format_exc()}", flush=True)
        else:
            shutil.rmtree(folder)
        self.tally.add(story.tally)
        seconds = time.monotonic() - self._began_s
        print(
            f"{self.tally.kills} of {self._count} after {seconds:.0f} s, {self.failed} failed: {self.tally}", flush=True
        )


if __name__ == "__main__":
    main()
