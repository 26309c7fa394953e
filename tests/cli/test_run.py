"""`kurt2rt run`, as a process of its own, with a person at its keyboard."""

import os
import resource
import signal
import subprocess
from pathlib import Path

import pytest

from kurt2rt.knowledge.fold import check_knowledge
from kurt2rt.knowledge.journal import Journal
from kurt2rt.knowledge.journal_file import log_of
from tests.cli.helpers import Running, running


def actions_in(knowledge: Path) -> list[str]:
    with Journal.read_only(knowledge) as journal:
        assert check_knowledge(journal) == []
        return [getattr(event, "rla").action for event in journal.events()]  # noqa: B009


def test_a_person_teaches_and_sigterm_ends_it_with_the_lesson_kept(tmp_path: Path) -> None:
    with running("run", "--seconds", "60", "--knowledge", "mine.knowledge", folder=tmp_path) as robot:
        robot.wait_for("I know nothing yet, teach me")
        robot.type("forward")
        robot.wait_for("RLA 1 taught: forward")
        robot.wait_for("  1 RLAs")
        said = robot.end(signal.SIGTERM)
    assert said.exit_code == 0
    assert said.err == ""
    assert said.out.splitlines()[-1] == "the robot stands; 1 RLAs are in mine.knowledge"
    assert actions_in(tmp_path / "mine.knowledge") == ["forward"]


def limit_files(process: "subprocess.Popen[str]", size_bytes: int) -> None:
    """No file of that process may grow beyond: writes fail for real, as they do on a full disk."""
    resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (size_bytes, resource.RLIM_INFINITY))


def fill_the_disk(robot: Running, knowledge: Path) -> None:
    """Teach once; then the disk is full, and a second lesson waits."""
    robot.wait_for("I know nothing yet, teach me")
    robot.type("stand")
    robot.wait_for("  1 RLAs")
    limit_files(robot.process, log_of(knowledge).stat().st_size)
    robot.type("replace 1 back")
    line = robot.wait_for("1 lessons not saved yet")
    assert "stands: unsaved" in line
    assert "mine.knowledge: the disk fails; look at its health and room" in line


@pytest.mark.deep
def test_a_full_disk_is_said_and_the_robot_goes_on_when_there_is_room(tmp_path: Path) -> None:
    knowledge = tmp_path / "mine.knowledge"
    with running("run", "--knowledge", "mine.knowledge", folder=tmp_path) as robot:
        fill_the_disk(robot, knowledge)
        limit_files(robot.process, resource.RLIM_INFINITY)
        robot.wait_for("back by RLA 1")
        said = robot.end(signal.SIGINT)
    assert (said.exit_code, said.err) == (0, "")
    with Journal.read_only(knowledge) as journal:
        assert len(journal.events()) == 2


@pytest.mark.deep
def test_a_disk_that_stays_full_is_the_last_word(tmp_path: Path) -> None:
    knowledge = tmp_path / "mine.knowledge"
    with running("run", "--knowledge", "mine.knowledge", folder=tmp_path) as robot:
        fill_the_disk(robot, knowledge)
        said = robot.end(signal.SIGTERM)
    assert said.exit_code == 2
    (line,) = said.err.splitlines()
    assert line.startswith(f"kurt2rt: {knowledge}: the disk fails; look at its health and room")
    assert line.endswith("; closed with 1 lessons not written")
    assert actions_in(knowledge) == ["stand"]


@pytest.mark.deep
def test_a_reader_that_goes_away_does_not_stop_the_robot(tmp_path: Path) -> None:
    with running("run", "--seconds", "60", "--knowledge", "mine.knowledge", folder=tmp_path) as robot:
        robot.wait_for("I know nothing yet, teach me")
        robot.stop_reading()
        robot.type("stand")
        while not (tmp_path / "mine.knowledge").exists() or actions_in(tmp_path / "mine.knowledge") != ["stand"]:
            os.sched_yield()
        said = robot.end(signal.SIGTERM)
    assert "Traceback" not in said.err
    assert actions_in(tmp_path / "mine.knowledge") == ["stand"]
