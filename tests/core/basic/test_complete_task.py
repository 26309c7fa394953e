"""An action that is a complete task: a mid level, and the basic level that it commands."""

from pathlib import Path

import yaml

from config import CONFIG_DIR
from hal.robot import STANDSTILL
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.task_settings import load_task
from tests.behaviors.helpers import counts, sensed
from tests.core.basic.helpers import condition_at, keep, repertoire
from tests.core.rla.helpers import created

WALLS = counts(**dict.fromkeys(("s1", "s2", "s3", "s4", "s5", "s6", "s7", "s8"), 0.1))
BASIC_LEVEL = (
    created(1, condition_at(WALLS), "spin_left", behaviour="turn_left"),
    created(2, condition_at(WALLS), "spin_right", behaviour="turn_right"),
)


def patrol(folder: Path, *mid_level: TeachingEvent, mid: str | None = "turns") -> str:
    """Write a task through streets and its knowledge file into `folder`; return the line of its action."""
    task = yaml.safe_load((CONFIG_DIR / "tasks" / "streets.yaml").read_text(encoding="utf-8"))
    task["name"] = "patrol"
    if mid is not None:
        task["mid"] = mid
    path = folder / "patrol.yaml"
    path.write_text(yaml.safe_dump(task), encoding="utf-8")
    keep(folder / "patrol.knowledge", load_task(str(path)), *BASIC_LEVEL, *mid_level)
    return f"kind: task, name: patrol, task: {path}, knowledge: patrol.knowledge"


def test_it_is_lost_where_the_mid_level_knows_no_answer(tmp_path: Path) -> None:
    action = repertoire(tmp_path, patrol(tmp_path, created(3, (9.0,) * 12, "turn_left", level=MID)))["patrol"]
    action.start()
    assert action.step(sensed(WALLS)) == STANDSTILL
    assert action.lost
