"""Commissioning over the kernel's CAN."""

from pathlib import Path

import pytest

from tests.checks.commission.typed import commission_the_rest, live, typing
from tests.checks.commission.workshop import Workshop

pytestmark = pytest.mark.hil


def test_a_person_types_and_the_file_is_written(
    vcan0: str, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    with Workshop(spec=vcan0) as workshop, live(workshop):
        commission_the_rest(typing(monkeypatch, capfd, tmp_path), vcan0, tmp_path, "identity", "stop")
