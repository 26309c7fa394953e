"""Wires as settings: the shipped ones, and what is refused."""

from pathlib import Path

import pytest
import yaml

from config import CONFIG_DIR
from hal.settings import SettingsError
from simbridge.wire.line import DirectLine, WiredLine, open_line, require_wire
from simbridge.wire.settings import load_wire

CYCLE_S = 0.01


def changed(folder: Path, **noise: object) -> str:
    content = yaml.safe_load((CONFIG_DIR / "wires" / "one_megabit.yaml").read_text(encoding="utf-8"))
    content["noise"].update(noise)
    path = folder / "mine.yaml"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    return str(path)


def test_the_shipped_wires_are_what_their_names_say() -> None:
    names = [path.stem for path in sorted((CONFIG_DIR / "wires").glob("*.yaml"))]
    assert names == ["failing", "ideal", "lossy", "one_megabit"]
    assert [load_wire(name).name for name in names] == names
    assert load_wire("one_megabit").bit_rate_bit_s == 1_000_000
    assert load_wire("lossy").loss.share == 0.1


def test_a_line_is_opened_by_name_or_path_and_none_is_no_wire(tmp_path: Path) -> None:
    assert isinstance(open_line("none", CYCLE_S, seed=1), DirectLine)
    line = open_line(changed(tmp_path, destroyed_share=0.5), CYCLE_S, seed=1)
    assert isinstance(line, WiredLine)
    assert line.wire.settings.noise.destroyed_share == 0.5
    line.robot_end.shutdown()
    line.notebook_end.shutdown()


def test_an_unknown_wire_is_refused_before_anything_is_opened() -> None:
    require_wire("none")
    require_wire("lossy")
    with pytest.raises(SettingsError, match=r"copper: no such file in wires; .* one of: failing, ideal, lossy"):
        require_wire("copper")


def test_bursts_that_overlap_are_refused(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match=r"bursts_s must be pairs \[begin, end\], each after the one before"):
        load_wire(changed(tmp_path, bursts_s=[[2.0, 2.5], [2.4, 3.0]]))


def test_a_tick_outside_of_the_robots_cycle_is_refused() -> None:
    with pytest.raises(SettingsError, match=r"notebook_phase_s is 0.005, allowed is less than .*0.002"):
        open_line("one_megabit", 0.002, seed=1)
