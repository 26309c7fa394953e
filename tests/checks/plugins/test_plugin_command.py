"""`kurt2rt plugin`: which parts there are, their texts, and skeletons that pass their tests."""

import json
import re
import tomllib
from pathlib import Path

import pytest

from behaviors.repertoire_settings import BEHAVIOURS
from config.settings_files import find_config
from kurt2rt.checks.plugins.kinds import KINDS, KindName
from kurt2rt.checks.plugins.skeleton import SkeletonKind
from tests.cli.helpers import ROOT, CommandLine, started
from tests.plugin_packages import install, write_parts


@pytest.fixture
def parts(plugin_folder: Path) -> Path:
    write_parts(plugin_folder, "parts_base")
    (plugin_folder / "parts_broken.py").write_text("NUMBER = 7\n")
    return plugin_folder


def test_kinds_of_the_command_line_are_all_kinds() -> None:
    assert list(KindName) == list(KINDS)


@pytest.mark.parametrize("kind", [pytest.param(SkeletonKind.LEARNERS, marks=pytest.mark.deep), SkeletonKind.ROBOTS])
def test_skeleton_installs_and_passes_its_tests(kurt2rt: CommandLine, plugin_folder: Path, kind: SkeletonKind) -> None:
    name = f"own_{kind}"
    made = kurt2rt("plugin", "new", kind, name, "--out", "out")
    steps = made.out.split("next:\n")[1].splitlines()
    assert [each.split()[:3] for each in steps[:2]] == [["pip", "install", "-e"], ["pytest", f"out/{name}"]], made.err
    assert steps[2].startswith("  kurt2rt ")
    with started("pytest", "-q", "-p", "no:cacheprovider", f"out/{name}", folder=plugin_folder) as tests:
        said = tests.communicate()[0]
    assert tests.returncode == 0, said
    assert int(re.findall(r"(\d+) passed", said)[0]) > 7
    project = tomllib.loads(Path("out", name, "pyproject.toml").read_text(encoding="utf-8"))["project"]
    install(plugin_folder / "out" / name / "src", project["name"], {kind: {name: f"{name}:OWN"}}, project["version"])
    assert project["entry-points"].keys() == {f"kurt2rt.{kind}"}
    listed = json.loads(kurt2rt("plugin", "list", "--kind", kind, "--json").out)["plugins"]
    assert {"kind": kind, "name": name, "source": f"own-{kind} 0.1.0", "note": ""} in listed


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("learners", "Nearest"), "cannot name a plug-in (got 'Nearest', allowed are a-z, 0-9 and _, "),
        (("learners", "tree"), "'tree' is the name of a shipped part or a module"),
        (("robots", "json"), "'json' is the name of a shipped part or a module"),
        (("robots", "hal"), "'hal' is the name of a shipped part or a module"),
        (("robots", "there"), "there: is there already; give another name or --out"),
    ],
)
def test_new_refuses_a_name_that_is_taken(
    kurt2rt: CommandLine, plugin_folder: Path, words: tuple[str, ...], told: str
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
        (("tasks", "fleing"), "no such name in tasks; give module:NAME, the path of a .yaml file, or one of: circle"),
        (("worlds", "rooms-3"), "no such name in worlds; give the path of a .yaml file, or one of: a, b"),
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
