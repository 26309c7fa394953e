"""Settings of the paper study, and their errors."""

import re
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
            r"growth\.task: .*'sledging'",
        ),
        ({"eight": "nine"}, "eight: .*'nine'; .*: fleeing, "),
        ({"testing_ground": "nowhere"}, "testing_ground: nowhere: "),
        ({"worlds": ["a", "nowhere"]}, r"worlds\.1: nowhere: "),
    ],
)
def test_load_paper_names_file_and_key_of_missing_parts(changed: dict[str, Any], said: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(SHIPPED | changed))
    with pytest.raises(SettingsError, match=f"^{re.escape(str(path))}: {said}"):
        load_paper(str(path), STAGE)


def test_load_paper_accepts_the_shipped_settings() -> None:
    assert load_paper(factory=STAGE) == load_paper()
