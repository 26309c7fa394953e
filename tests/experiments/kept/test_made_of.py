"""What decides a result shows in its fingerprint, and what does not decide it doesn't."""

from pathlib import Path

import pytest

from config import CONFIG_DIR
from kurt2rt.experiments.kept.made_of import Fingerprints, code_of, sources
from kurt2rt.experiments.paper.programme import OWN
from kurt2rt.tasks.settings import load_task
from tests.experiments.helpers import ROBOT, STAGE

TASK = load_task("wall_following")


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


def test_what_the_paper_reports_decides_nothing(fingerprints: Fingerprints) -> None:
    other = TASK.model_copy(update={"paper": TASK.paper.model_copy(update={"rlas": 1})})
    assert fingerprints.of(other, ("a",)) == fingerprints.of(TASK, ("a",))


def test_another_world_and_another_robot_show(fingerprints: Fingerprints) -> None:
    made = fingerprints.of(TASK, ("a",))
    assert made.differences(fingerprints.of(TASK, ("a", "rooms-3"))) == ["worlds"]
    other = ROBOT.model_copy(update={"name": "other"})
    assert made.differences(Fingerprints(STAGE, other, "s").of(TASK, ("a",))) == ["robot"]


def test_the_source_is_what_teaches_drives_and_keeps_what_came_and_not_what_only_shows_it() -> None:
    modules = dict(sources(OWN))
    assert {name for name in modules if "/paper/" in name} == OWN
    assert {"kurt2rt/tick.py", "kurt2rt/experiments/exam.py", "simbridge/free_poses.py", "hal/kurt2.py"} <= set(modules)
    assert "behaviors/policies/streets.py" in modules
    assert not any(name.startswith(("kurt2rt/cli/", "kurt2rt/page/")) for name in modules)
    assert all(path.is_file() for path in modules.values())


def test_comments_docstrings_and_layout_are_no_source() -> None:
    plain = code_of("def speed(m, s):\n    return m / s\n")
    assert code_of('"""What."""\n\ndef speed(m, s):  # fast\n    """Metres."""\n    return (m / s)\n') == plain
    assert code_of("def speed(m, s):\n    return s / m\n") != plain
