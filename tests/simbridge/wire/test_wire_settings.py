"""Settings of wires: the shipped files, and the checks."""

from pathlib import Path

import pytest

from config import CONFIG_DIR
from hal.settings import SettingsError
from simbridge.wire.line import DirectLine, WiredLine, open_line, require_wire
from simbridge.wire.settings import load_wire
from tests.simbridge.wires import changed

CYCLE_S = 0.01


def test_shipped_wires_have_the_settings_of_their_names() -> None:
    names = [path.stem for path in sorted((CONFIG_DIR / "wires").glob("*.yaml"))]
    assert names == ["failing", "ideal", "lossy", "one_megabit"]
    assert [load_wire(name).name for name in names] == names
    assert load_wire("one_megabit").bit_rate_bit_s == 1_000_000
    assert load_wire("lossy").loss.share == 0.1


def test_open_line_takes_a_path_or_none(tmp_path: Path) -> None:
    assert isinstance(open_line("none", CYCLE_S, seed=1), DirectLine)
    line = open_line(changed(tmp_path, noise={"destroyed_share": 0.5}), CYCLE_S, seed=1)
    assert isinstance(line, WiredLine)
    assert line.wire.settings.noise.destroyed_share == 0.5
    line.robot_end.shutdown()
    line.notebook_end.shutdown()


def test_require_wire_unknown_name_is_refused() -> None:
    require_wire("none")
    require_wire("lossy")
    with pytest.raises(SettingsError, match="failing, ideal, lossy"):
        require_wire("copper")


def test_load_wire_overlapping_bursts_are_refused(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match="bursts_s"):
        load_wire(changed(tmp_path, noise={"bursts_s": [[2.0, 2.5], [2.4, 3.0]]}))


def test_open_line_tick_outside_of_the_cycle_is_refused() -> None:
    with pytest.raises(SettingsError, match="notebook_phase_s"):
        open_line("one_megabit", 0.002, seed=1)
