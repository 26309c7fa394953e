"""Settings of the paper study, and their errors."""

from pathlib import Path
from typing import Any

import pytest
import yaml

from config import CONFIG_DIR
from hal.settings import SettingsError
from kurt2rt.experiments.paper.settings import load_paper
from tests.experiments.helpers import STAGE

SHIPPED = yaml.safe_load((CONFIG_DIR / "paper" / "basic_level.yaml").read_text())


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        (
            {"growth": SHIPPED["growth"] | {"task": "sledging"}},
            "growth.task: there is no experiment with task 'sledging'",
        ),
        ({"eight": "nine"}, "eight: there is no experiment with task 'nine'; give one of: fleeing, wall_following, "),
        ({"testing_ground": "nowhere"}, "testing_ground: nowhere: no such file in worlds"),
        ({"worlds": ["a", "nowhere"]}, "worlds.1: nowhere: no such file in worlds"),
    ],
)
def test_load_paper_names_file_and_key_of_missing_parts(changed: dict[str, Any], said: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(SHIPPED | changed))
    with pytest.raises(SettingsError) as caught:
        load_paper(str(path), STAGE)
    assert str(caught.value).startswith(f"{path}: {said}")


def test_load_paper_accepts_the_shipped_settings() -> None:
    assert load_paper(factory=STAGE) == load_paper()
