"""Hash of a plug-in's source: its package or file, and what it imports from the same folder."""

from pathlib import Path

import pytest

from config.plugin_source import plugins_in_use, source_hash_of
from config.plugins import PluginKind
from config.robot_plugins import ROBOTS
from tests.plugin_packages import install

CLASSES = PluginKind("classes", "class", "a class", lambda found: isinstance(found, type), tuple)


def write(folder: Path, **files: str) -> None:
    """Write files by their names, in which two underscores stand for a slash and one more for a dot."""
    for name, text in files.items():
        path = folder / f"{name.replace('__', '/')}.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)


def test_source_hash_of_a_package_covers_all_of_its_files(plugin_folder: Path) -> None:
    write(plugin_folder, plug_h__more="")
    (plugin_folder / "plug_h" / "__init__.py").write_text("class Nine:\n    pass\n")
    found = CLASSES.find("plug_h:Nine")
    hashes = {before := source_hash_of(found)}
    write(plugin_folder, plug_h__more="# more\n")
    hashes.add(source_hash_of(found))
    (plugin_folder / "plug_h" / "weights.json").write_text("[1]")
    hashes.add(source_hash_of(found))
    assert before
    assert len(hashes) == 3


def test_source_hash_of_a_part_of_the_project_is_empty() -> None:
    assert source_hash_of(PluginKind) == ""


@pytest.mark.parametrize(
    ("files", "changed", "differs"),
    [
        ({"plug_i": "import plug_j\n", "plug_j": "HERE = 1\n"}, "plug_j", True),
        ({"plug_i": "def late():\n    from plug_j import HERE\n", "plug_j": "HERE = 1\n"}, "plug_j", True),
        ({"plug_i": "import plug_j\n", "plug_j": "from plug_k import A\n", "plug_k": "A = 1\n"}, "plug_k", True),
        ({"plug_i": "import plug_l.deep\n", "plug_l__deep": "HERE = 1\n"}, "plug_l__deep", True),
        ({"plug_i": "# plug_j is of another plug-in\n", "plug_j": "HERE = 1\n"}, "plug_j", False),
        ({"plug_i": "import random\n", "random": "HERE = 1\n"}, "random", False),
        ({"plug_i": "import plug_j\n", "plug_j": "def f(:\n"}, "plug_j", True),
    ],
)
def test_source_hash_of_a_file_covers_what_it_imports(
    plugin_folder: Path, files: dict[str, str], changed: str, differs: bool
) -> None:
    class_text = "\n\nclass Nine:\n    pass\n"
    write(plugin_folder, plug_i=class_text[2:])
    found = CLASSES.find("plug_i:Nine")
    write(plugin_folder, **(files | {"plug_i": files["plug_i"] + class_text}))
    before = source_hash_of(found)
    write(plugin_folder, **{changed: files[changed] + "# changed\n"})
    assert (source_hash_of(found) != before) == differs


def test_source_hash_covers_a_package_without_init(plugin_folder: Path) -> None:
    write(plugin_folder, plug_m__learner="class Nine:\n    pass\n", plug_m__help="")
    found = CLASSES.find("plug_m.learner:Nine")
    before = source_hash_of(found)
    write(plugin_folder, plug_m__help="HERE = 1\n")
    assert source_hash_of(found) not in ("", before)


def test_source_hash_of_an_installed_file_takes_no_strangers(
    plugin_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    packages = plugin_folder / "site-packages"
    packages.mkdir()
    monkeypatch.syspath_prepend(packages)
    write(packages, plug_n="import plug_o\n\n\nclass Nine:\n    pass\n", plug_o="HERE = 1\n")
    found = CLASSES.find("plug_n:Nine")
    before = source_hash_of(found)
    write(packages, plug_o="HERE = 2\n")
    assert source_hash_of(found) == before != ""


def test_plugins_in_use_name_version_and_hash(plugin_folder: Path) -> None:
    write(plugin_folder, plug_p="class Nine:\n    pass\n", plug_q="class Ten:\n    pass\n")
    install(plugin_folder, "nines", {"classes": {"nine": "plug_p:Nine"}}, "1.2")
    hashes = [source_hash_of(CLASSES.find(name))[:8] for name in ("nine", "plug_q:Ten")]
    ROBOTS.find("kurt2")
    assert plugins_in_use() == (
        f"classes nine from nines 1.2, hash {hashes[0]}",
        f"classes plug_q:Ten from {plugin_folder / 'plug_q.py'}, hash {hashes[1]}",
    )
