"""`kurt2rt plugin check` tries each part on the robot that it is for."""

import json
from pathlib import Path

import pytest
import yaml

from hal.settings_files import find_config
from tests.cli.helpers import CommandLine
from tests.plugin_packages import install

POLICY = """
from behaviors.policies.distances import Distances
from behaviors.policies.policy import PolicySettings


class {name}(PolicySettings):
    def build(self, infrared):
        return Ahead(Distances(infrared).of("{sensor}"))


class Ahead:
    def __init__(self, ahead):
        self._ahead = ahead

    def choose(self, infrared_counts, behaviour):
        return "{action}" if min(self._ahead(infrared_counts)) < 0.1 else "forward"
"""
SCHOOL = POLICY.format(name="Dodging", sensor="p2", action="sharp_left")
KURT2 = POLICY.format(name="Careful", sensor="s1", action="spin_left")


@pytest.fixture
def folder(plugin_folder: Path) -> Path:
    """Return a folder with a policy of the school robot and one of KURT2, and tasks that name them."""
    (plugin_folder / "parts_school.py").write_text(SCHOOL)
    (plugin_folder / "parts_kurt2.py").write_text(KURT2)
    write_task(plugin_folder / "dodge.yaml", "school/fleeing", {"kind": "parts_school:Dodging"}, robot="school")
    points = {"policies": {"dodging": "parts_school:Dodging", "careful": "parts_kurt2:Careful"}}
    lines = ["[project]", "name = 'two'"]
    for group, parts in points.items():
        lines += [f"[project.entry-points.'kurt2rt.{group}']", *(f"{name} = '{part}'" for name, part in parts.items())]
    (plugin_folder / "pyproject.toml").write_text("\n".join(lines))
    return plugin_folder


def write_task(path: Path, like: str, policy: dict[str, str], **more: str) -> None:
    content = yaml.safe_load(find_config("tasks", like).read_text(encoding="utf-8"))
    path.write_text(yaml.safe_dump(content | {"policy": policy} | more), encoding="utf-8")


def test_policy_is_checked_on_the_robot_that_is_named(kurt2rt: CommandLine, folder: Path) -> None:
    target = "parts_school:Dodging"
    on_kurt2 = kurt2rt("plugin", "check", target)
    assert on_kurt2.exit_code == 1
    assert f"{target} (policies): breaks promises, tried on the robot kurt2 (--robot-settings names" in on_kurt2.out
    keeps = f"{target} (policies): keeps all promises\n"
    assert kurt2rt("plugin", "check", target, "--robot-settings", "school").out == keeps
    settings = folder / "mine.yaml"
    settings.write_bytes(find_config("robots", "school").read_bytes())
    assert kurt2rt("plugin", "check", target, "--robot-settings", settings).out == keeps


@pytest.mark.usefixtures("folder")
def test_parts_of_a_folder_are_checked_on_their_robots(kurt2rt: CommandLine) -> None:
    said = kurt2rt("plugin", "check", ".", "--json")
    assert said.exit_code == 0, said.out
    tried = {each["name"]: each["robot"] for each in json.loads(said.out)["plugins"]}
    assert tried == {"parts_school:Dodging": "school", "parts_kurt2:Careful": "kurt2"}


def test_parts_of_a_folder_follow_a_robots_own_files(kurt2rt: CommandLine, folder: Path) -> None:
    (folder / "dodge.yaml").unlink()
    for kind, name in (("robots", "school"), ("tasks", "school/fleeing")):
        (folder / "data" / kind).mkdir(parents=True)
        own = folder / "data" / kind / f"{Path(name).name}.yaml"
        own.write_bytes(find_config(kind, name).read_bytes())
    write_task(own, "school/fleeing", {"kind": "dodging"})
    said = kurt2rt("plugin", "check", ".", "--robot-settings", "turtlebot", "--json")
    tried = {each["name"]: each["robot"] for each in json.loads(said.out)["plugins"]}
    assert tried == {"parts_school:Dodging": "school", "parts_kurt2:Careful": "turtlebot"}


def test_policy_of_a_robot_without_tasks_is_refused(kurt2rt: CommandLine, folder: Path) -> None:
    assert kurt2rt("plugin", "new", "robots", "lone").exit_code == 0
    (folder / "lone/src/lone/data/tasks/fleeing.yaml").unlink()
    install(folder / "lone/src", "lone", {"robots": {"lone": "lone:LONE"}})
    refused = kurt2rt.refused("plugin", "check", "parts_school:Dodging", "--robot-settings", "lone")
    assert "robot lone: has no task, so nothing says its actions; add a task to its folder" in refused


@pytest.mark.usefixtures("folder")
def test_task_is_checked_on_its_own_robot(kurt2rt: CommandLine) -> None:
    assert kurt2rt("plugin", "check", "dodge.yaml").out == "dodge.yaml (tasks): keeps all promises\n"
