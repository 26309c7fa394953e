"""Provenance: changes that decide a result, and changes that do not."""

from pathlib import Path

import pytest

from config import CONFIG_DIR
from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.study import provenance
from kurt2rt.experiments.study.provenance import Fingerprints, program_hash
from tests.experiments.helpers import ROBOT, STAGE
from tests.plugin_packages import write_parts, write_repertoire, write_task

TASK = load_task("wall_following")


@pytest.fixture(scope="module")
def fingerprints() -> Fingerprints:
    return Fingerprints(STAGE, ROBOT)


def test_a_change_in_the_file_of_a_mid_level_shows(tmp_path: Path) -> None:
    mine = tmp_path / "mine.yaml"
    shipped = (CONFIG_DIR / "mid_levels" / "places.yaml").read_text(encoding="utf-8")
    mine.write_text(shipped, encoding="utf-8")
    task = load_task("errands").model_copy(update={"mid": str(mine)})
    made = Fingerprints(STAGE, ROBOT).of(task, ("manhattan",))
    assert made == Fingerprints(STAGE, ROBOT).of(task, ("manhattan",))
    mine.write_text(shipped.replace("wall_m: 0.40", "wall_m: 0.42"), encoding="utf-8")
    assert made.differences(Fingerprints(STAGE, ROBOT).of(task, ("manhattan",))) == ["task"]


def test_fingerprints_ignore_the_papers_numbers(fingerprints: Fingerprints) -> None:
    other = TASK.model_copy(update={"paper": TASK.paper.model_copy(update={"rlas": 1})})
    assert fingerprints.of(other, ("a",)) == fingerprints.of(TASK, ("a",))


def test_program_hash_is_that_of_the_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "speeds.py"
    (tmp_path / "speeds.yaml").write_text("speed: 1\n", encoding="utf-8")
    monkeypatch.setattr(provenance, "files", lambda _: tmp_path)
    hashes = []
    for text in ("return m / s", "return m / s  # fast"):
        path.write_text(f"def speed(m, s):\n    {text}\n", encoding="utf-8")
        program_hash.cache_clear()
        hashes += [program_hash(".py"), program_hash(".py", ".yaml")]
    program_hash.cache_clear()
    assert hashes[0] == "3b779c8780af724e"  # on every Python
    assert len(set(hashes)) == 4


def test_change_in_the_source_of_a_plugin_shows(plugin_folder: Path) -> None:
    write_parts(plugin_folder, "parts_made")
    repertoire = write_repertoire(plugin_folder, {"kind": "parts_made:Wiggling", "name": "wiggle"})
    path = write_task(plugin_folder, policy={"kind": "parts_made:Turning"})
    task = load_task(str(path))
    by_action = TASK.model_copy(update={"repertoire": str(repertoire)})
    fingerprints = Fingerprints(STAGE, ROBOT)
    made = [fingerprints.of(each, ("a",)) for each in (task, by_action)]
    file = plugin_folder / "parts_made.py"
    file.write_text(file.read_text(encoding="utf-8") + "# changed\n", encoding="utf-8")
    changed = [fingerprints.of(each, ("a",)) for each in (task, by_action)]
    assert [one.differences(other) for one, other in zip(made, changed, strict=True)] == [["plugins"], ["plugins"]]
