"""`kurt2rt sim`: the simulated robot as a program of its own, and a runtime that meets it on a bus."""

import os
from pathlib import Path

from tests.cli.helpers import CommandLine
from tests.cli.three_programs import BRAKING_CYCLES, WATCHDOG_CYCLES, teach_kill_and_return


def a_bus(name: str) -> str:
    return f"shared:{name}-{os.getpid()}"


async def test_killed_program_stops_within_the_watchdog_and_comes_back(tmp_path: Path) -> None:
    cycles = await teach_kill_and_return(a_bus("story"), tmp_path)
    assert cycles <= WATCHDOG_CYCLES + BRAKING_CYCLES


def test_it_ends_when_its_time_or_its_input_is_over(kurt2rt: CommandLine) -> None:
    for until in (("--seconds", "0.1"), ("--while-stdin",)):
        assert " collisions, " in kurt2rt("sim", "--bus", a_bus("short"), *until).out.splitlines()[-1]
