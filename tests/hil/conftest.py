from pathlib import Path

import pytest


@pytest.fixture
def vcan0() -> str:
    """Name of the kernel's virtual CAN interface, which is up. Fails where there is none: `make hil` gives one."""
    try:
        flags = int(Path("/sys/class/net/vcan0/flags").read_text(encoding="ascii"), 16)
    except OSError:
        pytest.fail("no interface vcan0: run this with `make hil`, or with python -m tests.hil.machine COMMAND")
    assert flags & 1, "the interface vcan0 is down: some test before did not set it up again"
    return "vcan0"
