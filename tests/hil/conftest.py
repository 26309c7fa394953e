from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.hil.drive import Drive
from tests.hil.link import NAME, Link

_IFF_UP, _IFF_ECHO = 0x1, 0x40000


@pytest.fixture
def vcan0() -> str:
    """Name of the kernel's virtual CAN interface, which is up. Fails where there is none: `make hil` gives one."""
    try:
        flags = int(Path(f"/sys/class/net/{NAME}/flags").read_text(encoding="ascii"), 16)
    except OSError:
        pytest.fail("no interface vcan0: run this with `make hil`, or with python -m tests.hil.machine COMMAND")
    assert flags & _IFF_UP, "the interface vcan0 is down: some test before did not set it up again"
    assert flags & _IFF_ECHO, "vcan is loaded without echo=1, so own frames come back before the bus has carried them"
    return NAME


@pytest.fixture
def link(vcan0: str) -> Iterator[Link]:
    """Return the interface for a test that changes it; restore it afterwards."""
    assert vcan0 == NAME
    link = Link()
    yield link
    link.restore()


@pytest.fixture
def drive(vcan0: str) -> Iterator[Drive]:
    """Return a robot that drives over vcan0."""
    with Drive(vcan0) as drive:
        drive.until_it_drives()
        yield drive
