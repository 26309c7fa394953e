"""Provenance: changes that decide a result, and changes that do not."""

from pathlib import Path

import pytest

from config import CONFIG_DIR
from hal.kurt2 import Kurt2
from kurt2rt.core.task_settings import load_task
from kurt2rt.core.tick import Tick
from kurt2rt.experiments.lockstep.exam import examine
from kurt2rt.experiments.paper.extent import Extent
from kurt2rt.experiments.paper.plan import DECIDING
from kurt2rt.experiments.study import provenance
from kurt2rt.experiments.study.import_graph import modules_needed
from kurt2rt.experiments.study.provenance import Fingerprints, source_hash
from kurt2rt.knowledge.journal.writer import JournalWriter
from kurt2rt.runtime import Runtime
from simbridge.survey.free_poses import FreePoses
from tests.experiments.helpers import ROBOT, STAGE
from tests.plugin_packages import write_parts, write_repertoire, write_task

TASK = load_task("wall_following")
NOT_DECIDING = (
    "kurt2rt.channel",
    "kurt2rt.cli",
    "kurt2rt.runs.explain",
    "kurt2rt.checks.faults",
    "kurt2rt.service.health",
    "kurt2rt.teacher.page",
    "kurt2rt.runs.recording",
    "kurt2rt.checks.soak",
)
"""Packages in which a change keeps all results."""


@pytest.fixture(scope="module")
def fingerprints() -> Fingerprints:
    return Fingerprints(STAGE, ROBOT, "s")


def test_the_same_is_the_same(fingerprints: Fingerprints) -> None:
    assert fingerprints.of(TASK, ("a", "b")) == fingerprints.of(TASK, ("b", "a", "a"))


def test_a_change_of_the_task_shows(fingerprints: Fingerprints) -> None:
    made = fingerprints.of(TASK, ("a",))
    learning = TASK.model_copy(update={"learning": TASK.learning.model_copy(update={"radius": 701.0})})
    policy = TASK.model_copy(update={"policy": TASK.policy.model_copy(update={"tolerance_m": 0.03})})
    assert made.differences(fingerprints.of(learning, ("a",))) == ["task"]
    assert made.differences(fingerprints.of(policy, ("a",))) == ["task"]


def test_a_change_in_the_file_of_a_mid_level_shows(tmp_path: Path) -> None:
    mine = tmp_path / "mine.yaml"
    shipped = (CONFIG_DIR / "mid_levels" / "places.yaml").read_text(encoding="utf-8")
    mine.write_text(shipped, encoding="utf-8")
    task = load_task("errands").model_copy(update={"mid": str(mine)})
    made = Fingerprints(STAGE, ROBOT, "s").of(task, ("manhattan",))
    assert made == Fingerprints(STAGE, ROBOT, "s").of(task, ("manhattan",))
    mine.write_text(shipped.replace("wall_m: 0.40", "wall_m: 0.42"), encoding="utf-8")
    assert made.differences(Fingerprints(STAGE, ROBOT, "s").of(task, ("manhattan",))) == ["task"]


def test_fingerprints_ignore_the_papers_numbers(fingerprints: Fingerprints) -> None:
    other = TASK.model_copy(update={"paper": TASK.paper.model_copy(update={"rlas": 1})})
    assert fingerprints.of(other, ("a",)) == fingerprints.of(TASK, ("a",))


def test_another_world_and_another_robot_show(fingerprints: Fingerprints) -> None:
    made = fingerprints.of(TASK, ("a",))
    assert made.differences(fingerprints.of(TASK, ("a", "rooms-3"))) == ["worlds"]
    other = ROBOT.model_copy(update={"name": "other"})
    assert made.differences(Fingerprints(STAGE, other, "s").of(TASK, ("a",))) == ["robot"]


def test_source_hash_only_needs_what_jobs_import() -> None:
    modules = modules_needed(each.__module__ for each in (*DECIDING, type(STAGE)))
    deciding = {Tick, examine, FreePoses, Kurt2, Runtime, Extent, JournalWriter}
    assert {each.__module__ for each in deciding} <= set(modules)
    assert "behaviors.policies.streets" in modules  # by its kind alone
    assert all(modules_needed([package]) for package in NOT_DECIDING)  # there are such packages
    assert not [name for name in modules if name.startswith(NOT_DECIDING)]
    assert all(path.is_file() for path in modules.values())


def test_source_hash_names_outside_the_program_change_nothing() -> None:
    assert modules_needed(["numpy", "tests.experiments.helpers"]) == {}
    assert source_hash(*DECIDING) == source_hash(*DECIDING, Path)
    assert source_hash(*DECIDING) != source_hash(*DECIDING, type(STAGE))


def test_source_hash_is_that_of_the_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "speeds.py"
    monkeypatch.setattr(provenance, "modules_needed", lambda _: {"speeds": path})
    path.write_text("def speed(m, s):\n    return m / s\n", encoding="utf-8")
    assert source_hash(Tick) == "f62b1b2aa32c9a5d"  # on every Python
    path.write_text("def speed(m, s):\n    return m / s  # fast\n", encoding="utf-8")
    assert source_hash(Tick) != "f62b1b2aa32c9a5d"


def test_change_in_the_source_of_a_plugin_shows(plugin_folder: Path) -> None:
    write_parts(plugin_folder, "parts_made")
    repertoire = write_repertoire(plugin_folder, {"kind": "parts_made:Wiggling", "name": "wiggle"})
    path = write_task(plugin_folder, policy={"kind": "parts_made:Turning"})
    task = load_task(str(path))
    by_action = TASK.model_copy(update={"repertoire": str(repertoire)})
    fingerprints = Fingerprints(STAGE, ROBOT, "s")
    made = [fingerprints.of(each, ("a",)) for each in (task, by_action)]
    file = plugin_folder / "parts_made.py"
    file.write_text(file.read_text(encoding="utf-8") + "# changed\n", encoding="utf-8")
    changed = [fingerprints.of(each, ("a",)) for each in (task, by_action)]
    assert [one.differences(other) for one, other in zip(made, changed, strict=True)] == [["plugins"], ["plugins"]]
