"""`import kurt2rt`: a simulated robot is stepped, taught, asked and saved without async."""

import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

import kurt2rt
from kurt2rt.core.rla.events import LessonUndone, SessionBegun, TeachingEvent
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.show.knowledge import knowledge_data, render_knowledge


@pytest.fixture
def robot() -> Iterator[kurt2rt.SimulatedRobot]:
    with kurt2rt.SimulatedRobot(task="wall_following", world="a", seed=1) as robot:
        yield robot


def test_library_import_loads_nothing_heavy() -> None:
    heavy = ("numpy", "anyio", "pydantic", "yaml", "can", "matplotlib", "pymunk", "networkx")
    program = f"import sys, kurt2rt; print([name for name in {heavy} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_library_each_promised_name_is_there() -> None:
    assert dir(kurt2rt) == sorted(kurt2rt.__all__)
    assert all(getattr(kurt2rt, name) for name in kurt2rt.__all__)


def test_library_unknown_name_is_refused_with_the_allowed() -> None:
    with pytest.raises(AttributeError, match=r"'Robot'.*SimulatedRobot"):
        _ = kurt2rt.Robot  # type: ignore[attr-defined]


def test_simulated_robot_asks_and_drives_as_taught(robot: kurt2rt.SimulatedRobot) -> None:
    assert str(robot.question).endswith("situation\nNothing was taught yet.")
    before = robot.pose
    robot.teach("back")
    robot.step(20)
    assert robot.action == "back"
    assert robot.question is None
    assert robot.pose != before
    assert robot.seconds == pytest.approx(0.22)


def test_simulated_robot_teach_while_driving_corrects(robot: kurt2rt.SimulatedRobot) -> None:
    robot.teach("forward")
    robot.teach("stand")
    assert [rla.action for rla in robot.rlas] == ["stand"]


def test_senses_side_is_its_nearest_sensor_in_metres(robot: kurt2rt.SimulatedRobot) -> None:
    senses = robot.senses
    places = [name for name in senses if name.startswith("front ")]
    assert len(places) == 5
    assert senses["front"].metres == min(senses[name].metres for name in places) == pytest.approx(0.33, abs=0.02)
    assert not senses["right"].detects
    assert senses["right"].metres == 0.6


def test_save_keeps_lessons_and_refuses_another_file(robot: kurt2rt.SimulatedRobot, tmp_path: Path) -> None:
    robot.teach("forward")
    saved = robot.save(tmp_path / "mine.knowledge")
    robot.teach("stand")
    with pytest.raises(kurt2rt.Error, match=r"mine\.knowledge"):
        robot.save(tmp_path / "mine.knowledge")
    assert [rla.action for rla in kurt2rt.Knowledge.load(saved.path).rlas] == ["forward"]


def test_simulated_robot_with_a_path_keeps_each_lesson(tmp_path: Path) -> None:
    file = tmp_path / "kept.knowledge"
    with kurt2rt.SimulatedRobot(world="a", seed=1, path=file) as robot:
        robot.teach("forward")
    assert [rla.action for rla in kurt2rt.Knowledge.load(file).rlas] == ["forward"]
    with pytest.raises(kurt2rt.Error, match=r"kept\.knowledge: there is a file already"):
        kurt2rt.SimulatedRobot(path=file)


def test_simulated_robot_goes_on_from_saved_knowledge(robot: kurt2rt.SimulatedRobot, tmp_path: Path) -> None:
    robot.teach("forward")
    first = robot.save(tmp_path / "first.knowledge")
    before = first.path.read_bytes()
    with kurt2rt.SimulatedRobot(knowledge=first, world="a", seed=1) as again:
        again.teach("stand")
        second = again.save(tmp_path / "second.knowledge")
    assert (first.lessons, second.lessons) == (1, 2)
    assert first.path.read_bytes() == before


def test_simulated_robot_bad_input_is_one_clear_error(robot: kurt2rt.SimulatedRobot) -> None:
    with pytest.raises(kurt2rt.Error, match=r"action: unknown \(got 'fly', allowed forward, "):
        robot.teach("fly")
    with pytest.raises(kurt2rt.Error, match=r"senses: unknown \(got 'top', allowed front, "):
        robot.senses["top"]
    with pytest.raises(kurt2rt.Error, match="seconds: not a duration"):
        robot.run(float("nan"))
    with pytest.raises(kurt2rt.Error, match="ticks: not a number of steps"):
        robot.step(0)
    with pytest.raises(kurt2rt.Error, match="task streets: has a mid level or several behaviours"):
        kurt2rt.SimulatedRobot(task="streets")
    robot.close()
    with pytest.raises(kurt2rt.Error, match="SimulatedRobot: is closed"):
        robot.step()


async def test_examine_works_where_an_event_loop_runs(robot: kurt2rt.SimulatedRobot, tmp_path: Path) -> None:
    robot.teach("forward")
    result = kurt2rt.examine(robot.save(tmp_path / "one.knowledge"), worlds=["a"], seeds=[1, 2], seconds=2)
    assert [drive.seed for drive in result.drives] == [1, 2]
    assert repr(result).endswith(f"{result.passed} of {result.judged} judged drives passed")
    assert result._repr_html_().count("<tr>") == 3


def test_knowledge_counts_lessons_as_the_command_does(
    robot: kurt2rt.SimulatedRobot, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    robot.teach("forward")
    robot.teach("stand")
    saved = robot.save(tmp_path / "mine.knowledge")
    with Journal.read_only(saved.path) as journal:
        binding = journal.binding
    with Journal.open(saved.path, binding) as journal:
        newest = journal.events()[-1].origin.command_id
        said: list[TeachingEvent] = [LessonUndone(newest, replace(journal.events()[-1].origin, command_id="undo"))]
        said += [SessionBegun("s", replace(said[0].origin, command_id="session"))]
        journal.append([JournalEntry(each, "2026-11-28T00:00:00Z") for each in said])
    known = kurt2rt.Knowledge.load(saved.path)
    assert (len(known.events), known.lessons) == (4, 1)
    assert "1 RLAs from 1 lessons" in repr(known)
    with Journal.read_only(saved.path) as journal:
        shown = render_knowledge(journal)
        assert knowledge_data(journal)["lessons"] == 1
    Console(width=200).print(shown)
    assert "1 RLAs from 1 lessons (" in capsys.readouterr().out
