"""The sentence of a task to its teacher, from its file to the page's introduction."""

from pathlib import Path

import pytest

from config.settings import SettingsError
from config.settings_files import find_config
from kurt2rt.core.task_settings import load_task


def task_file(folder: Path, what: str) -> Path:
    lines = find_config("tasks", "wall_following").read_text().splitlines()
    path = folder / "mine.yaml"
    path.write_text("\n".join(what if line.startswith("description:") else line for line in lines))
    return path


def test_sentence_of_two_lines_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match="description"):
        load_task(str(task_file(tmp_path, 'description: "one\\ntwo"')))
