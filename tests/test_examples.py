"""The examples of the documentation teach a robot and end by themselves."""

import json
import re
import runpy
import sys
import tempfile
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from matplotlib import pyplot as plt

import kurt2rt.teacher
from kurt2rt.channel.security.pairing import local_pairing
from kurt2rt.teacher import Teacher
from tests.forked_robot import fork_robots

EXAMPLES = Path(__file__).parents[1] / "docs" / "examples"
SCRIPT = EXAMPLES / "teach_from_a_script.py"
NOTEBOOK = EXAMPLES / "teach_in_a_notebook.ipynb"
LIBRARY_NOTEBOOK = EXAMPLES / "use_as_a_library.ipynb"


@pytest.fixture(autouse=True)
def _forked_robots(monkeypatch: pytest.MonkeyPatch) -> None:
    fork_robots(monkeypatch)


@pytest.fixture
def _no_figures_left() -> Iterator[None]:
    yield
    plt.close("all")


def run_script(monkeypatch: pytest.MonkeyPatch, *words: str) -> None:
    monkeypatch.setattr(sys, "argv", [SCRIPT.name, *words])
    runpy.run_path(str(SCRIPT), run_name="__main__")


def cells(path: Path) -> list[str]:
    """Return the code cells of a notebook in order."""
    notebook = json.loads(path.read_text(encoding="utf-8"))
    return ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]


def run_notebook(path: Path = NOTEBOOK, **shorter: float) -> dict[str, Any]:
    """Execute the cells in order; `shorter` gives constants of the notebook another value."""
    names: dict[str, Any] = {"__name__": "__main__"}
    for cell in cells(path):
        source = cell
        for name, value in shorter.items():
            source = re.sub(rf"^{name} = .*$", f"{name} = {value}", source, flags=re.MULTILINE)
        exec(compile(source, path.name, "exec"), names)
    return names


def lessons_printed(text: str) -> tuple[int, int]:
    """Return the number of lessons, and the percentage of time that the robot drove by itself."""
    told = re.search(r"(\d+) lessons, \d+ RLAs; then it drove by itself (\d+)% of the time$", text.strip())
    assert told, text
    return int(told[1]), int(told[2])


def test_the_script_teaches_and_ends(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    run_script(monkeypatch, "--seconds", "1.5")
    lessons, _ = lessons_printed(capsys.readouterr().out)
    assert lessons >= 1


def test_the_script_without_a_robot_says_so_in_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kurt2rt.teacher, "Teacher", partial(Teacher, connect_s=0.1), raising=False)
    device = local_pairing(tmp_path / "teachers", tmp_path / "devices", port=1).device.folder
    with pytest.raises(SystemExit, match=r"kurt2rt run$") as end:
        run_script(monkeypatch, str(device))
    assert "\n" not in str(end.value)


@pytest.mark.usefixtures("_no_figures_left")
async def test_the_notebook_runs_in_a_running_loop() -> None:
    # Async although it awaits nothing: Jupyter runs its cells inside a loop as well.
    names = run_notebook(TEACHING_S=1.5, WATCHING_S=0.5)
    assert len(names["lessons"]) >= 1
    assert names["alone"]
    assert [len(figure.axes) for figure in map(plt.figure, plt.get_fignums())] == [1, 2, 1]
    assert names["robot"]._process is None


def test_the_notebook_shows_the_plots_of_its_last_run() -> None:
    outputs = [
        output
        for cell in json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]
        for output in cell.get("outputs", ())
    ]
    assert sum("image/png" in output.get("data", {}) for output in outputs) == 3
    assert not any(output["output_type"] == "error" for output in outputs)


async def test_notebook_of_the_library_runs_in_a_running_loop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    names = run_notebook(LIBRARY_NOTEBOOK, SECONDS=3.0)
    assert names["run"].exact
    assert names["taught"].rlas
    assert len(names["result"].drives) == 1
    assert names["robot"].plot()._repr_png_().startswith(b"\x89PNG")


@pytest.mark.deep
@pytest.mark.usefixtures("_no_figures_left")
def test_a_minute_of_lessons_lets_the_robot_drive(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    run_script(monkeypatch)
    lessons, alone = lessons_printed(capsys.readouterr().out)
    assert lessons >= 20
    assert alone >= 50
    names = run_notebook()
    assert len(names["lessons"]) >= 20
    assert names["share"] >= 0.5
