"""`make kills`: the robot program is killed so many times, in shards that may run on several machines."""

import argparse
import tempfile
import time
from pathlib import Path

import anyio

from tests.crash.kill_story import KillStory, Tally

_AT_ONCE = 50


def main() -> None:
    """Kill; tell every minute; an assertion says what was lost."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=10_000, help="of all shards together")
    parser.add_argument("--shard", default="1/1", metavar="I/N", help="which one this is, such as 1/8")
    arguments = parser.parse_args()
    shard, shards = (int(number) for number in arguments.shard.split("/"))
    if not 1 <= shard <= shards:
        parser.error(f"there is no shard {arguments.shard}")
    kills = kills_of_shard(arguments.kills, shard, shards)
    began_s = time.monotonic()
    done, all_of_them = 0, Tally()
    while done < kills:
        count = min(_AT_ONCE, kills - done)
        seed = shard * 1_000_000 + done
        tally = kill_in_a_fresh_folder(count, seed)
        done += count
        all_of_them.add(tally)
        print(
            f"shard {shard}/{shards}, {done} of {kills} after {time.monotonic() - began_s:.0f} s: {tally}", flush=True
        )
    print(all_of_them)
    print(f"{kills} passed, 0 failed")


def kills_of_shard(kills: int, shard: int, shards: int) -> int:
    """How many of all kills are those of a shard, from 1."""
    return kills * shard // shards - kills * (shard - 1) // shards


def kill_in_a_fresh_folder(kills: int, seed: int) -> Tally:
    """So many kills of programs that write one knowledge file; which ones, the seed decides."""
    with tempfile.TemporaryDirectory(prefix="kurt2rt-kills-") as folder:
        story = KillStory(Path(folder), f"shared:kills-{seed}", seed)
        return anyio.run(story.run, kills)


if __name__ == "__main__":
    main()
