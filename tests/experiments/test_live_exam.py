"""The exam of a robot that runs: its process, and what the robot's program makes of it."""

import json
import re
import sys
from pathlib import Path

import pytest
import yaml

from config import CONFIG_DIR
from hal.robot_settings import load_robot
from kurt2rt.channel.protocol.simulation import EXAM, NO_EXAM, ExamStatus
from kurt2rt.cli import exam_process
from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.lockstep.drive_row import NOT_JUDGED_BECAUSE
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import open_knowledge
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.service.live_exam import LiveExam
from tests.knowledge.lessons import BINDING, STAMP, created
from tests.knowledge.refusals import refused
from tests.patience import PATIENCE_S

OVER = ExamStatus(False, 1.0, "Passed in 0 of 1 worlds.")


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    path = tmp_path / "copy.knowledge"
    path.write_bytes(b"")
    return path


def saying(*lines: str, taught: Path = Path("/dev/null/file"), after: str = "") -> "LiveExam":
    """Return an exam whose process prints these lines, then runs `after`."""
    script = "import sys, time\n" + "".join(f"print({line!r}, flush=True)\n" for line in lines) + after
    return LiveExam(lambda _, picture: (sys.executable, "-c", script, str(picture)), taught)


def ended(exam: LiveExam) -> ExamStatus:
    assert exam._reading is not None
    exam._reading.join(PATIENCE_S)
    return exam.status


def test_live_exam_returns_verdict_and_picture(copy: Path, tmp_path: Path) -> None:
    drawn = "open(sys.argv[1], 'wb').close()"
    taught, picture = tmp_path / "walls.knowledge", tmp_path / "exams" / "exam.png"
    with Journal.open(taught, BINDING) as journal:
        journal.append([JournalEntry(created(1), STAMP)])
    picture.parent.mkdir()
    with saying("a word of some library", json.dumps(EXAM.plain_of(OVER)), taught=taught, after=drawn) as exam:
        exam.begin(copy, picture)
        told = ended(exam)
    assert (told.text, told.picture, told.trouble, told.running) == (OVER.text, "exam.png", "", False)
    assert not copy.exists()
    again = saying(taught=taught)
    assert (again.status, again.picture) == (told, picture), "the next run on that file tells it again"
    taught.rename(tmp_path / "kept.knowledge")
    Journal.open(taught, BINDING).close()
    assert saying(taught=taught).status == NO_EXAM, "of a new file at the old place"
    assert saying(taught=tmp_path / "kept.knowledge").status == told


def test_an_exam_is_over_only_with_its_picture(copy: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = "open(sys.argv[1], 'wb').close()"
    exam = saying(json.dumps(EXAM.plain_of(OVER)), "a last word", after=drawn)
    progress: list[ExamStatus] = []

    def note(each: LiveExam, name: str, value: object) -> None:
        object.__setattr__(each, name, value)
        if isinstance(value, ExamStatus):
            progress.append(value)

    monkeypatch.setattr(LiveExam, "__setattr__", note)
    exam.begin(copy, tmp_path / "exam.png")
    ended(exam)
    assert [(each.running, each.picture) for each in progress] == [(True, ""), (False, "exam.png")]


def test_a_process_that_dies_is_told_as_trouble(copy: Path, tmp_path: Path) -> None:
    with saying("[1", after="sys.exit(3)") as exam:
        exam.begin(copy, tmp_path / "exam.png")
        told = ended(exam)
    assert "(code 3)" in told.trouble
    assert not told.running


def test_one_exam_at_a_time_and_the_end_of_the_program_ends_it(copy: Path, tmp_path: Path) -> None:
    exam = saying(after="time.sleep(60)")
    exam.begin(copy, tmp_path / "exam.png")
    with refused(KnowledgeCode.EXAM_RUNS):
        exam.begin(tmp_path / "second.knowledge", tmp_path / "second.png")
    exam.close()
    assert not exam.status.running
    assert not copy.exists()


def test_its_process_draws_and_judges(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    settings = yaml.safe_load((CONFIG_DIR / "tasks" / "wall_following.yaml").read_text(encoding="utf-8"))
    settings["exam"] |= {"worlds": ["a"], "duration_s": 2.0}
    task, picture = tmp_path / "short.yaml", tmp_path / "exams" / "exam.png"
    task.write_text(yaml.safe_dump(settings), encoding="utf-8")
    knowledge = tmp_path / "nothing.knowledge"
    open_knowledge(knowledge, load_robot(), load_task(str(task))).close()
    exam_process._examine(knowledge, picture, "kurt2", str(task), 1)
    progress = [EXAM.read(json.loads(line)) for line in capsys.readouterr().out.splitlines()]
    shares = [each.share for each in progress]
    assert shares == sorted(shares)
    (verdict,) = progress[-1].verdicts
    assert (re.findall(r"\d", progress[-1].text), verdict.passed, verdict.world) == (["0", "1"], False, "A")
    assert re.search(r"^0\.\d\d .*laps", verdict.text)
    assert verdict.judged
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_exam_process_without_a_measure_does_not_judge(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    repertoire = yaml.safe_load((CONFIG_DIR / "repertoires" / "basic.yaml").read_text(encoding="utf-8"))
    for action in repertoire["actions"]:
        action |= {key: round(speed / 10, 2) for key, speed in action.items() if key in ("left_m_s", "right_m_s")}
    slow = tmp_path / "slow.yaml"
    slow.write_text(yaml.safe_dump(repertoire), encoding="utf-8")
    settings = yaml.safe_load((CONFIG_DIR / "tasks" / "wall_following.yaml").read_text(encoding="utf-8"))
    settings["exam"] |= {"worlds": ["a"], "duration_s": 2.0}
    task = tmp_path / "slow_task.yaml"
    task.write_text(yaml.safe_dump(settings | {"repertoire": str(slow)}), encoding="utf-8")
    knowledge = tmp_path / "nothing.knowledge"
    open_knowledge(knowledge, load_robot(), load_task(str(task))).close()
    exam_process._examine(knowledge, tmp_path / "exam.png", "kurt2", str(task), 1)
    progress = EXAM.read(json.loads(capsys.readouterr().out.splitlines()[-1]))
    (verdict,) = progress.verdicts
    assert re.findall(r"\d", progress.text) == ["0", "0", "1"]
    assert (verdict.passed, verdict.judged) == (False, False)
    assert verdict.text.startswith(NOT_JUDGED_BECAUSE)


def test_knowledge_of_another_task_is_told_in_a_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    knowledge = tmp_path / "eight.knowledge"
    open_knowledge(knowledge, load_robot(), load_task("eight")).close()
    with refused(KnowledgeCode.OTHER_TASK):
        exam_process._examine(knowledge, tmp_path / "exam.png", "kurt2", "wall_following", 1)
    assert capsys.readouterr().out == ""
