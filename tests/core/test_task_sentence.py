"""The sentence of a task to its teacher, from its file to the page's introduction."""

from pathlib import Path

import pytest

from hal.settings import SettingsError
from hal.settings_files import find_config
from kurt2rt.core.task_settings import load_task

SHIPPED = sorted(path.stem for path in find_config("tasks", "circle").parent.glob("*.yaml"))


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_task_says_what_it_is(name: str) -> None:
    what = load_task(name).description
    assert what is not None
    assert what.split()[0] in ("Teach", "Lead")


def task_file(folder: Path, what: str) -> Path:
    lines = find_config("tasks", "wall_following").read_text().splitlines()
    path = folder / "mine.yaml"
    path.write_text("\n".join(what if line.startswith("description:") else line for line in lines))
    return path


def test_task_without_a_sentence_is_told_by_its_name(tmp_path: Path) -> None:
    assert load_task(str(task_file(tmp_path, ""))).sentence.endswith("wall following")


def test_sentence_of_two_lines_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match="description"):
        load_task(str(task_file(tmp_path, 'description: "one\\ntwo"')))
