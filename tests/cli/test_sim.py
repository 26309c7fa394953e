"""`kurt2rt sim`: the simulated robot as a program of its own, and a runtime that meets it on a bus."""

import os
from pathlib import Path

import pytest

from tests.cli.helpers import CommandLine, unknown_name
from tests.cli.three_programs import BRAKING_CYCLES, WATCHDOG_CYCLES, teach_kill_and_return


def a_bus(name: str) -> str:
    return f"shared:{name}-{os.getpid()}"


async def test_killed_program_stops_within_the_watchdog_and_comes_back(tmp_path: Path) -> None:
    cycles = await teach_kill_and_return(a_bus("story"), tmp_path)
    assert cycles <= WATCHDOG_CYCLES + BRAKING_CYCLES


def test_it_ends_when_its_time_or_its_input_is_over(kurt2rt: CommandLine) -> None:
    for until in (("--seconds", "0.1"), ("--while-stdin",)):
        assert " collisions, " in kurt2rt("sim", "--bus", a_bus("short"), *until).out.splitlines()[-1]


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (("--bus", "can7"), "bus 'can7': "),
        (("--world", "nope"), unknown_name("worlds", "nope")),
        (("--robot-settings", "nope"), unknown_name("robots", "nope")),
        (("--start", "99"), " 99"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_sim_with_an_unknown_name_is_refused(kurt2rt: CommandLine, words: tuple[str, ...], why: str) -> None:
    assert why in kurt2rt.refused("sim", *words)


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (("--bus", "virtual:x"), "--bus"),
        (("--seconds", "inf"), "--seconds"),
        (("--start", "0"), "--start"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_sim_with_a_senseless_value_is_misuse(kurt2rt: CommandLine, words: tuple[str, ...], why: str) -> None:
    assert why in kurt2rt.misused("sim", *words)
