"""`kurt2rt plugin`: skeletons of all kinds pass their check; parts that break promises are named."""

import json
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml

from behaviors.repertoire_settings import BEHAVIOURS
from hal.plugins import loaded_plugins
from hal.settings_files import find_config
from kurt2rt.checks.plugins.kinds import KINDS, KindName
from tests.cli.helpers import ROOT, CommandLine
from tests.plugin_packages import install, write_parts, write_repertoire, write_task

BROKEN = """
import random
from behaviors.judges.judge import JudgeSettings
from behaviors.policies.policy import PolicySettings
from parts_base import Reach, Turning, Wiggling


class Part:
    unit, needs_reset, behaviour, finished, lost = "m", False, "", False, 0

    def __init__(self):
        self.asked = 0
        self.progress = 1.0

    def choose(self, infrared_counts, behaviour):
        self.asked += 1
        return "forward" if self.asked % 3 else "fly"

    def judge(self, features):
        self.asked += 1
        return self.asked % 4

    def start(self):
        pass

    def step(self, readings):
        self.asked += 1
        return self.asked, 0.0

    def reset(self, pose):
        self.progress += 1.0

    def update(self, pose):
        pass

    def abort(self):
        raise RuntimeError("not now")

    @property
    def findings(self):
        return {"odd": float("nan")}


class Policy(PolicySettings):
    def build(self, infrared):
        return Part()


class Judge(JudgeSettings):
    def build(self):
        return Part()


class Metric(Reach):
    def build(self, simulation, behaviours, chance):
        return Part()


class Action(Wiggling):
    def build(self, robot):
        return Part()


class Needy(Turning):
    wanted_m: float


def world():
    return {
        "name": "shaky",
        "size_m": [3.0, 3.0],
        "infrared_rays": 1,
        "outline": [[0, 0], [3, 0], [3, 3], [0, 3], [0, 0]],
        "start_poses": [{"x_m": random.uniform(1.0, 2.0), "y_m": 1.5, "heading_deg": 0}],
    }


NUMBER = 7
"""


@pytest.fixture
def parts(plugin_folder: Path) -> Path:
    write_parts(plugin_folder, "parts_base")
    (plugin_folder / "parts_broken.py").write_text(BROKEN)
    return plugin_folder


def test_kinds_of_the_command_line_are_all_kinds() -> None:
    assert list(KindName) == list(KINDS)


@pytest.mark.parametrize("kind", KindName)
def test_skeleton_of_each_kind_passes_its_check(kurt2rt: CommandLine, plugin_folder: Path, kind: KindName) -> None:
    name = f"own_{kind}"
    made = kurt2rt("plugin", "new", kind, name, "--out", "out")
    assert made.exit_code == 0, made.err
    project = tomllib.loads(Path("out", name, "pyproject.toml").read_text(encoding="utf-8"))["project"]
    ((group, points),) = project["entry-points"].items()
    checked = kurt2rt("plugin", "check", Path("out", name))
    first, *notes = checked.out.splitlines()
    assert first == f"{points[name]} ({kind}): keeps all promises", checked.err
    assert [note.startswith("  decide takes ") for note in notes] == [True] * (kind == KindName.LEARNERS)
    assert group == f"kurt2rt.{kind}"
    install(plugin_folder / "out" / name / "src", project["name"], {kind: points}, project["version"])
    listed = json.loads(kurt2rt("plugin", "list", "--kind", kind, "--json").out)["plugins"]
    assert {"kind": kind, "name": name, "source": f"own-{kind} 0.1.0", "note": ""} in listed
    assert kurt2rt("plugin", "check", name).out.startswith(f"{name} ({kind}): keeps all promises\n")
    assert [(each.group, each.name) for each in loaded_plugins()][-1] == (kind, name)


@pytest.mark.deep
def test_skeleton_passes_the_test_that_it_brings(kurt2rt: CommandLine, plugin_folder: Path) -> None:
    kurt2rt("plugin", "new", "worlds", "own_hall")
    words = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "own_hall"]
    done = subprocess.run(words, cwd=plugin_folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize(
    ("part", "broken"),
    [
        ("Policy", ["`choose` names an action of the repertoire", "`choose` has no memory"]),
        ("Judge", ["`judge` returns -1, 0 or 1", "`judge` has no memory"]),
        (
            "Metric",
            [
                "`progress` begins at 0",
                "`progress` and `findings` are finite",
                "`reset` adds no",
                "`abort` ends a drive",
            ],
        ),
        ("Action", ["`step` returns two speeds of at most", "`start` resets its state", "`finished` and `lost` are"]),
        ("world", ["it is the same each time"]),
    ],
)
@pytest.mark.usefixtures("parts")
def test_check_names_the_broken_promises(kurt2rt: CommandLine, part: str, broken: list[str]) -> None:
    said = kurt2rt("plugin", "check", f"parts_broken:{part}", "--json")
    assert said.exit_code == 1
    ((checked,),) = json.loads(said.out).values()
    assert len(checked["broken"]) == len(broken)
    assert all(line.startswith(begin) for line, begin in zip(checked["broken"], broken, strict=True))


def test_check_of_a_task_tries_all_of_its_parts(kurt2rt: CommandLine, parts: Path) -> None:
    actions = write_repertoire(parts, {"kind": "parts_broken:Action", "name": "leap"})
    sections = {"policy": {"kind": "parts_broken:Policy"}, "judge": {"kind": "parts_broken:Judge"}}
    path = write_task(parts, repertoire=str(actions), course={"kind": "parts_broken:Metric"}, **sections)
    said = kurt2rt("plugin", "check", path)
    assert said.exit_code == 1
    first, *lines = said.out.splitlines()
    assert first.startswith(f"{path} (tasks): breaks promises, tried on the robot kurt2 ")
    assert {line.partition(":")[0].strip() for line in lines} == {"policy", "judge", "course", "action leap"}


def test_check_refuses_a_judge_of_a_robot_that_sees_farther(kurt2rt: CommandLine, tmp_path: Path) -> None:
    """KURT2's judge calls 0.25 m narrow; the school robot sees 0.14 m."""
    sections = yaml.safe_load(find_config("tasks", "school/wall_following").read_text(encoding="utf-8"))
    del sections["judge"]
    path = write_task(tmp_path, **sections)
    said = kurt2rt("plugin", "check", str(path), "--robot-settings", "school")
    assert said.exit_code == 1
    assert "judge: `judge` does not punish what the policy does where nothing is in view" in said.out
    assert kurt2rt("plugin", "check", "school/wall_following").exit_code == 0


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("nothing_of_this_name",), "there is no such plug-in; give module:Name, a folder, a YAML file, or a name of"),
        (("wall_following",), "its kind is not clear; give --kind, one of: judges, policies, tasks"),
        (("parts_broken:NUMBER",), "its kind is not clear; give --kind, one of: behaviours, judges, "),
        (("parts_broken:Needy",), "its setting wanted_m has no default; give it one, or check the file of a task"),
        (("parts_broken:Policy", "--kind", "judges"), "is the class Policy, allowed is a subclass of JudgeSettings"),
        (("motor", "--kind", "behaviours"), "its setting left_m_s has no default"),
        (("empty",), "pyproject.toml: cannot be read: "),
        (("other",), "pyproject.toml: offers no plug-in; add an entry point of one of: kurt2rt.learners, "),
        (("gone.yaml",), "gone.yaml: cannot be read"),
    ],
)
def test_check_refuses_what_it_cannot_try(
    kurt2rt: CommandLine,
    parts: Path,
    words: tuple[str, ...],
    told: str,
) -> None:
    (parts / "empty").mkdir()
    (parts / "other").mkdir()
    (parts / "other" / "pyproject.toml").write_text("[project]\nname = 'other'\n")
    assert told in kurt2rt.refused("plugin", "check", *words)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("policies", "Wandering"), "is no name of a plug-in (got 'Wandering', allowed are a-z, 0-9 and _, "),
        (("policies", "circle"), "'circle' is the name of a shipped part or a module"),
        (("tasks", "json"), "'json' is the name of a shipped part or a module"),
        (("tasks", "hal"), "'hal' is the name of a shipped part or a module"),
        (("worlds", "there"), "there: is there already; give another name or --out"),
    ],
)
def test_new_refuses_a_name_that_is_taken(
    kurt2rt: CommandLine,
    plugin_folder: Path,
    words: tuple[str, ...],
    told: str,
) -> None:
    (plugin_folder / "there").mkdir()
    assert told in kurt2rt.refused("plugin", "new", *words)


@pytest.mark.parametrize(
    ("words", "file"),
    [
        (("tasks", "fleeing"), "config/tasks/fleeing.yaml"),
        (("tasks", "school/fleeing"), "kurt2rt/robots/school/data/tasks/fleeing.yaml"),
        (("worlds", "a"), "config/worlds/a.yaml"),
        (("robots", "school"), "kurt2rt/robots/school/data/robots/school.yaml"),
        (("repertoires", "school/basic"), "kurt2rt/robots/school/data/repertoires/basic.yaml"),
        (("situations", "basic"), "config/situations/basic.yaml"),
        (("policies", "sector_fleeing"), "behaviors/policies/sector_fleeing.py"),
        (("learners", "k-nn"), "kurt2rt/core/learner/neighbours.py"),
        (("policies", "parts_base:Turning"), "tests/plugin_parts.py"),
        (("behaviours", "parts_base:Wiggling"), "tests/plugin_parts.py"),
        (("worlds", "hall"), "tests/plugin_parts.py"),
        (("worlds", "yard"), "config/worlds/b.yaml"),
    ],
)
def test_show_prints_the_file_of_a_part(kurt2rt: CommandLine, parts: Path, words: tuple[str, ...], file: str) -> None:
    (parts / "parts_yard.py").write_text(f"YARD = {str(find_config('worlds', 'b'))!r}")
    install(parts, "places", {"worlds": {"hall": "parts_base:Turning", "yard": "parts_yard:YARD"}})
    assert kurt2rt("plugin", "show", *words).out == (ROOT / file).read_text(encoding="utf-8")


@pytest.mark.parametrize("name", BEHAVIOURS.shipped())
def test_show_prints_the_settings_of_a_shipped_action(kurt2rt: CommandLine, name: str) -> None:
    said = kurt2rt("plugin", "show", "behaviours", name).out
    assert said.startswith("class ")
    assert f'kind: Literal["{name}"]' in said


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("tasks", "fleing"), "no such file in tasks; give module:NAME, a path to a .yaml file or one of: circle"),
        (("worlds", "rooms-3"), "no such file in worlds; give a path to a .yaml file or one of: a, b"),
        (("judges", "harsh"), "there is no kind 'harsh'; give module:Name, or one of: eight, fleeing"),
        (("behaviours", "leap"), "there is no such action; give module:Name, or one of: motor"),
        (("policies", "parts_broken:NUMBER"), "is a int, allowed is a subclass of PolicySettings"),
    ],
)
@pytest.mark.usefixtures("parts")
def test_show_refuses_what_is_not_there(kurt2rt: CommandLine, words: tuple[str, ...], told: str) -> None:
    assert told in kurt2rt.refused("plugin", "show", *words)


def test_list_says_which_names_lead_elsewhere(kurt2rt: CommandLine, plugin_folder: Path) -> None:
    install(plugin_folder, "ours", {"policies": {"circle": "parts_no:A", "turning": "parts_no:B"}})
    install(plugin_folder, "theirs", {"policies": {"turning": "parts_no:C"}})
    listed = json.loads(kurt2rt("plugin", "list", "--kind", "policies", "--json").out)["plugins"]
    assert [(each["name"], each["source"], each["note"]) for each in listed if each["source"] != "kurt2rt"] == [
        ("circle", "ours 1.0", "hidden by the shipped one"),
        ("turning", "ours 1.0", "refused: two packages offer this name"),
        ("turning", "theirs 1.0", "refused: two packages offer this name"),
    ]
    assert [each["name"] for each in listed[:2]] == ["circle", "eight"]
