"""An action that is itself a taught RLA system."""

from pathlib import Path

import pytest

from behaviors.repertoire import load_repertoire
from config.settings import SettingsError
from hal.robot import STANDSTILL, WheelSpeeds
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.task_settings import load_task
from tests.behaviors.helpers import ROBOT, SENSORS, counts, sensed
from tests.core.basic.helpers import condition_at, keep, repertoire, with_repertoire
from tests.core.rla.helpers import created

FREE, WALL, CORNER = counts(), counts(s1=0.07, s2=0.07, s3=0.07, s4=0.07), counts(s9=0.1, s10=0.1, s11=0.1)
FORWARD = WheelSpeeds(0.30, 0.30)
WALL_FOLLOWING = load_task("wall_following")
FOLLOW = "kind: taught, name: follow_wall, task: wall_following, knowledge: taught.knowledge"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with knowledge: forward along a wall, spin right at a corner, no RLA of free space."""
    along, off = created(1, condition_at(WALL), "forward"), created(2, condition_at(CORNER), "spin_right")
    keep(tmp_path / "taught.knowledge", WALL_FOLLOWING, along, off)
    return tmp_path


def test_a_taught_action_may_be_made_of_taught_ones(folder: Path) -> None:
    outer = with_repertoire(WALL_FOLLOWING, folder, FOLLOW).model_copy(update={"name": "patrol"})
    (folder / "patrol.yaml").write_text(outer.model_dump_json(exclude_unset=True))
    keep(folder / "patrol.knowledge", outer, created(1, condition_at(WALL), "follow_wall", radius=100_000.0))
    beyond = folder / "beyond"
    beyond.mkdir()
    patrol = f"kind: taught, name: patrol, task: {folder / 'patrol.yaml'}, knowledge: ../patrol.knowledge"
    action = repertoire(beyond, patrol)["patrol"]
    action.start()
    assert action.step(sensed(WALL)) == FORWARD
    assert action.step(sensed(FREE)) == STANDSTILL
    assert action.lost


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (("taught.knowledge", "gone.knowledge"), r"gone\.knowledge: .* wall_following"),
        (("taught.knowledge", "other.knowledge"), r"other\.knowledge: .*history"),
        (("taught.knowledge", "repertoire.yaml"), r"follow_wall\): .*repertoire\.yaml: "),
        (("task: wall_following", "task: fleeing"), r"'wall_following', .*'fleeing'"),
        (("task: wall_following", "task: flying"), r"flying: .*\bwall_following\b"),
        (("name: follow_wall", "name: f, behaviour: turn"), "'turn'; .* without a name"),
        (("task: wall_following", "task: streets"), "''; .*: straight_on, turn_left, "),
    ],
)
def test_taught_action_that_cannot_act_is_refused(change: tuple[str, str], told: str, folder: Path) -> None:
    situation = load_situation("basic", SENSORS).model_copy(update={"history_steps": 7})
    (folder / "situation.yaml").write_text(situation.model_dump_json(exclude_unset=True))
    keep(folder / "other.knowledge", WALL_FOLLOWING.model_copy(update={"situation": str(folder / "situation.yaml")}))
    with pytest.raises(SettingsError, match=told) as caught:
        repertoire(folder, FOLLOW.replace(*change))
    assert str(caught.value).startswith(f"{folder / 'repertoire.yaml'}: actions.0 (f")


def test_knowledge_of_an_action_that_its_task_lacks_is_refused(tmp_path: Path) -> None:
    keep(tmp_path / "taught.knowledge", WALL_FOLLOWING, created(1, condition_at(WALL), "fly"))
    with pytest.raises(SettingsError, match=r"\(follow_wall\): RLA 1 .*\bfly\b"):
        repertoire(tmp_path, FOLLOW)


def test_repertoire_without_rla_systems_refuses_taught_actions(folder: Path) -> None:
    path = with_repertoire(WALL_FOLLOWING, folder, FOLLOW).repertoire
    with pytest.raises(SettingsError, match=r"actions\.0 \(follow_wall\): .*\btaught\b"):
        load_repertoire(path, ROBOT)
