"""Repertoires: built by name from their files, for one robot."""

from pathlib import Path

import pytest

from behaviors.repertoire import load_repertoire
from config import CONFIG_DIR
from config.settings import SettingsError
from tests.behaviors.helpers import ROBOT

BASIC = (CONFIG_DIR / "repertoires" / "basic.yaml").read_text()


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [("front_sensor: s1,", "front_sensor: s19,", " s19;"), ("back_sensor: s2,", "back_sensor: s1,", " s1 and s1 ")],
)
def test_load_repertoire_wrong_sensor_names_the_entry(old: str, new: str, told: str, tmp_path: Path) -> None:
    path = tmp_path / "repertoire.yaml"
    path.write_text(BASIC.replace(old, new, 1))
    with pytest.raises(SettingsError) as caught:
        load_repertoire(str(path), ROBOT)
    assert str(caught.value).startswith(f"{path}: actions.14 (along_left_wall): ")
    assert told in str(caught.value)
    assert " s1, s2, s3, " in str(caught.value)
