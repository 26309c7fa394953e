"""`kurt2rt run` and `kurt2rt teach --terminal`, as processes of their own, with a person at the keyboard."""

import re
import resource
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import can
import pytest

from hal.bus import CONTROL_ID
from hal.codec import load_codec
from kurt2rt.core.decision.decision import StandReason
from kurt2rt.core.decision.standing import Standing, short_text
from kurt2rt.core.rla.events import RlaCreated
from kurt2rt.knowledge.journal.journal_file import log_of
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from tests.cli.helpers import CommandLine, Running, running
from tests.cli.three_programs import brakes
from tests.knowledge.reading import events_in


def actions_in(knowledge: Path) -> list[str]:
    return [event.rla.action for event in events_in(knowledge) if isinstance(event, RlaCreated)]


class Lesson(NamedTuple):
    """A robot and a person who teaches it from a terminal."""

    robot: Running
    person: Running
    knowledge: Path


@contextmanager
def lesson(folder: Path) -> Iterator[Lesson]:
    """Start a robot and a terminal that teaches it."""
    with running("run", "--port", "0", "--knowledge", "mine.knowledge", folder=folder) as robot:
        port = robot.wait_for("teachers are listened to on UDP port").split()[-1]
        with running("teach", "--terminal", "--port", port, folder=folder) as person:
            person.wait_for("terminal teaches")
            yield Lesson(robot, person, folder / "mine.knowledge")


def test_a_terminal_does_what_a_page_does(tmp_path: Path) -> None:
    with lesson(tmp_path) as (_, person, knowledge):
        for line, answer in (
            ("stand", "RLA 1 taught: stand"),
            ("begin monday", "session 'monday' begins"),
            ("replace 1 back", "RLA 1 corrected: back instead of stand"),
            ("undo", "undone: RLA 1 corrected: back instead of stand"),
            ("", "the robot stands until you type go"),
            ("go", "the robot may drive"),
            ("phase 2", "phase 2, corrections"),
            ("delete 7", "refused: there is no RLA 7"),
            ("step stand 0.2", "stand for 20 ticks"),
            ("lessons", "RLA 1 corrected: back instead of stand, undone"),
            ("save before lunch", "before-lunch.knowledge"),
            ("export", ".csv"),
            ("dance", "not done, dance: no such command or action"),
            ("end", "session 'monday' is over"),
        ):
            person.ask(line, answer)
        person.type("quit")
        person.wait_for("the robot has no teacher now")
        assert person.process.wait() == 0
    (copy,) = (tmp_path / "saved").iterdir()
    assert actions_in(copy)[0] == actions_in(knowledge)[0] == "stand"


def test_the_page_behind_a_proxy_is_opened_at_the_proxys_address(tmp_path: Path) -> None:
    words = ("teach", "--page-port", "0", "--port", "9", "--public-address", "https://robot.example")
    with running(*words, folder=tmp_path) as page:
        page.wait_for("https://robot.example/pair?token=")
        assert page.end(signal.SIGTERM).err == ""


def limit_files(program: Running, size_bytes: int) -> None:
    """Limit the size of that program's files, so that writes fail as on a full disk."""
    resource.prlimit(program.process.pid, resource.RLIMIT_FSIZE, (size_bytes, resource.RLIM_INFINITY))


def fill_the_disk(robot: Running, person: Running, knowledge: Path) -> None:
    """Teach once; then the disk is full, and a second lesson waits."""
    person.type("stand")
    person.wait_for("RLA 1 taught")
    robot.wait_for("  1 RLAs")
    limit_files(robot, log_of(knowledge).stat().st_size)
    person.type("replace 1 back")
    line = robot.wait_for("1 lessons not saved yet")
    assert short_text(Standing(StandReason.UNSAVED)) in line
    assert f"mine.knowledge: {KnowledgeCode.DISK_FAILS.text}" in line
    person.wait_for("refused: not saved yet; it may still count")


@pytest.mark.deep
def test_disk_that_stays_full_is_the_last_line_and_code_2(tmp_path: Path) -> None:
    with lesson(tmp_path) as (robot, person, knowledge):
        fill_the_disk(robot, person, knowledge)
        said = robot.end(signal.SIGTERM)
    assert said.exit_code == 2
    line = said.err.splitlines()[-1]
    assert line.startswith(f"kurt2rt: {knowledge}: {KnowledgeCode.DISK_FAILS.text}; ")
    assert " 1 lessons " in line
    assert actions_in(knowledge) == ["stand"]


@pytest.mark.deep
def test_a_reader_that_goes_away_does_not_stop_the_robot(tmp_path: Path) -> None:
    with lesson(tmp_path) as (robot, person, knowledge):
        robot.stop_reading()
        person.type("stand")
        person.wait_for("RLA 1 taught")
        said = robot.end(signal.SIGTERM)
    assert "Traceback" not in said.err
    assert actions_in(knowledge) == ["stand"]


def test_run_can_log_is_read_by_other_tools(kurt2rt: CommandLine, tmp_path: Path) -> None:
    words = ("run", "--seconds", "0.3", "--teacher", "none", "--knowledge", "mine.knowledge", "--can-log", "drive.log")
    said = kurt2rt(*words)
    with can.LogReader(tmp_path / "drive.log") as reader:
        frames = list(reader)
    assert re.search(rf"^{len(frames)} .* drive\.log$", said.out, re.MULTILINE)
    sent = [frame.arbitration_id for frame in frames if not frame.is_rx]
    assert set(sent) == {CONTROL_ID}
    heard = {frame.arbitration_id for frame in frames if frame.is_rx}
    assert {load_codec().message(name).frame_id for name in ("ADC00_03", "BDC00_03", "ENCODER", "BUMPERC")} <= heard
    assert brakes(frames[-1])  # the robot's last word

    said = kurt2rt(*words)
    assert " drive-2.log" in said.out


def test_run_without_a_teacher_selects_the_named_behaviour(kurt2rt: CommandLine) -> None:
    words = ("run", "--seconds", "1.1", "--teacher", "none", "--task", "streets")
    assert "about straight_on" in kurt2rt(*words).out
    assert "about turn_left" in kurt2rt(*words, "--behaviour", "turn_left").out
    refused = kurt2rt.misused(*words, "--behaviour", "fly")
    assert "'fly'" in refused
    assert ": straight_on, turn_left, turn_right" in refused


@pytest.mark.deep
def test_can_log_that_cannot_be_written_does_not_stop_the_robot(tmp_path: Path) -> None:
    words = ("run", "--teacher", "none", "--knowledge", "mine.knowledge", "--can-log", "drive.log")
    with running(*words, folder=tmp_path) as robot:
        log = tmp_path / "drive.log"
        while not log.exists() or log.stat().st_size < 200_000:  # so that the limit leaves the knowledge file room
            robot.wait_for("late")
        limit_files(robot, log.stat().st_size)
        line = robot.wait_for("CAN log drive.log: writing failed ([Errno 27] File too large), ")
        assert "missed" in line
        said = robot.end(signal.SIGTERM)
    assert (said.exit_code, said.err) == (0, "")
    assert "frames lost" in said.out.splitlines()[-2]
