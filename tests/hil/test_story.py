"""Robot, runtime and teacher as three programs on the kernel's own CAN."""

from pathlib import Path

import pytest

from tests.cli.three_programs import BRAKING_CYCLES, WATCHDOG_CYCLES, teach_kill_and_return

pytestmark = pytest.mark.hil


async def test_taught_over_the_socket_killed_while_it_drives_and_back_with_all_it_knew(
    vcan0: str, tmp_path: Path
) -> None:
    cycles = await teach_kill_and_return(vcan0, tmp_path)
    assert cycles <= WATCHDOG_CYCLES + BRAKING_CYCLES
