"""Knowledge is bound to the kind of robot that it was taught on, and finds its robot again."""

from pathlib import Path

import pytest

from config.robot_plugins import find_task_of_robot, plugin_task
from config.settings import SettingsError
from config.settings_files import find_config
from hal.robot_settings import load_robot
from kurt2rt.core.task_settings import load_task
from kurt2rt.knowledge.files.task_of_file import task_of_file
from kurt2rt.knowledge.journal.loading import open_knowledge
from kurt2rt.knowledge.knowledge_error import KnowledgeError

SCHOOL, FLEEING = load_robot("school"), load_task("school/fleeing")


def test_knowledge_of_another_kind_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "taught.knowledge"
    open_knowledge(path, SCHOOL, FLEEING).close()
    open_knowledge(path, SCHOOL.model_copy(update={"name": "a second one"}), FLEEING).close()
    with pytest.raises(KnowledgeError, match="the names are the same, but the kind of robot"):
        open_knowledge(path, SCHOOL.model_copy(update={"kind": "other"}), FLEEING)


def test_knowledge_names_the_task_of_its_robot(tmp_path: Path) -> None:
    path = tmp_path / "taught.knowledge"
    open_knowledge(path, SCHOOL, FLEEING).close()
    assert task_of_file(path) == "school/fleeing"


def test_first_task_of_a_robot_is_wall_following() -> None:
    assert find_task_of_robot("school") == "school/wall_following"
    assert find_task_of_robot("kurt2") is None
    assert find_task_of_robot("nope") is None
    assert plugin_task("nope") is None


def test_file_that_a_robot_lacks_is_refused_with_those_it_has() -> None:
    with pytest.raises(SettingsError, match=r"the robot school has no such file in tasks; it has: school/circle"):
        find_config("tasks", "school/nope")
    with pytest.raises(SettingsError, match=r"did you mean school/fleeing\?"):
        find_config("tasks", "school/fleing")
    with pytest.raises(SettingsError, match=r"no such name in tasks; .* did you mean school/fleeing\?"):
        find_config("tasks", "scool/fleeing")


def test_robot_of_an_unknown_kind_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text("kind: nope\n", encoding="utf-8")
    with pytest.raises(SettingsError, match=r"kind: there is no such robot \(found .nope.\); .*kurt2, school"):
        load_robot(str(path))
    for text in ("kind: [1]\n", "name: mine\n", "[1]\n"):
        path.write_text(text, encoding="utf-8")
        with pytest.raises(SettingsError, match=r"kind: should be a valid string"):
            load_robot(str(path))
