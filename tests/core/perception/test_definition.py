"""Situation definition and its fingerprint."""

from pathlib import Path

import pytest

from config import CONFIG_DIR
from hal.robot_settings import load_robot
from kurt2rt.core.perception.definition import load_situation
from tests.core.perception.helpers import ALL_KINDS, SENSORS, definition

BASIC = (CONFIG_DIR / "situations" / "basic.yaml").read_text()
ROBOT_SENSORS = load_robot().infrared.names


def hash_of(text: str, folder: Path) -> str:
    path = folder / "changed.yaml"
    path.write_text(text)
    return load_situation(str(path), ROBOT_SENSORS).hash(ROBOT_SENSORS, "kurt2")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("name: basic", "name: other"),
        ("history_steps: 1000", "history_steps: 999"),
        ("wheel_speed_counts_per_m_s: 0", "wheel_speed_counts_per_m_s: 1"),
        ("{kind: reading, sensor: s1}", "{kind: reading, sensor: s2}"),
        ("  - {kind: reading, sensor: s18}\n", ""),
        ("{kind: maximum, heading: left", "{kind: minimum, heading: left"),
        ("{kind: maximum, heading: left", "{kind: maximum, heading: right"),
        ("sensors: [s12, s13, s14]", "sensors: [s12, s14, s13]"),
        ("nearer: s1, farther: s2", "nearer: s1, farther: s3"),
        ("side: left", "side: right"),
    ],
)
def test_definition_hash_differs_for_each_change(old: str, new: str, tmp_path: Path) -> None:
    assert old in BASIC
    assert hash_of(BASIC.replace(old, new, 1), tmp_path) != hash_of(BASIC, tmp_path)


def test_definition_hash_ignores_comments_and_notation(tmp_path: Path) -> None:
    written_otherwise = "# taught in spring\n" + BASIC.replace("history_steps: 1000", "history_steps:   1_000")
    assert hash_of(written_otherwise, tmp_path) == hash_of(BASIC, tmp_path)


def test_definition_hash_depends_on_orders_and_kind() -> None:
    small = definition()
    swapped = definition((ALL_KINDS[1], ALL_KINDS[0], *ALL_KINDS[2:]))
    hashes = {
        small.hash(SENSORS, "kurt2"),
        small.hash(SENSORS[::-1], "kurt2"),
        small.hash((*SENSORS, "e"), "kurt2"),
        small.hash(SENSORS, "other"),
        swapped.hash(SENSORS, "kurt2"),
    }
    assert len(hashes) == 5


def test_definition_hash_is_constant() -> None:
    """Knowledge files hold it: a change here makes all of them unreadable for their robots."""
    assert load_situation("basic", ROBOT_SENSORS).hash(ROBOT_SENSORS, "kurt2") == "133f3f3bb801d15d"
