"""Robot, runtime and teacher as three programs on the kernel's own CAN."""

from pathlib import Path

import pytest

from tests.cli.three_programs import BRAKING_CYCLES, WATCHDOG_CYCLES, teach_kill_and_return

pytestmark = pytest.mark.hil


async def test_runtime_killed_while_driving_returns_with_its_knowledge(vcan0: str, tmp_path: Path) -> None:
    cycles = await teach_kill_and_return(vcan0, tmp_path)
    assert cycles <= WATCHDOG_CYCLES + BRAKING_CYCLES
