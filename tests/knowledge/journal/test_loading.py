import os
import re
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.rla.events import RlaCreated, SituationNamed, TeachingEvent
from kurt2rt.core.rla.rla import CRITIC, MID, Rla
from kurt2rt.core.rla.statistics import BEST_SCORE, Statistics
from kurt2rt.knowledge.journal.binding import KnowledgeBinding
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.fold import check_knowledge, fold_journal
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import open_for_teaching, open_knowledge, read_knowledge
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from tests.experiments.helpers import ROBOT, short_task
from tests.knowledge.lessons import (
    BINDING,
    STAMP,
    WITH_CRITIC,
    appraisal,
    begun,
    created,
    entry,
    origin,
    tamper,
    undone,
)
from tests.knowledge.refusals import refused


def contents(folder: Path) -> dict[str, bytes]:
    """Return all files of a folder except the empty ones of writers' locks."""
    return {each.name: each.read_bytes() for each in folder.iterdir() if each.is_file() and each.suffix != ".lock"}


def require_refused(
    path: Path, code: KnowledgeCode, binding: KnowledgeBinding = BINDING, **fields: object
) -> KnowledgeError:
    """Expect that opening the file is refused with this code, after which every file is as it was."""
    before = contents(path.parent)
    with refused(code, path, **fields) as caught:
        Journal.open(path, binding)
    assert contents(path.parent) == before
    return caught.value


def only_in(error: KnowledgeError) -> list[tuple[str, str]]:
    """Return owner and names of the features that only one of file and robot has."""
    return re.findall(r"the (file|robot) has ('.*?')(?:, only| and|$)", str(error.fields["difference"]))


def test_open_other_kinds_of_files_are_refused(path: Path) -> None:
    path.write_text("Dear diary,\n")
    require_refused(path, KnowledgeCode.NO_SQLITE_FILE)
    path.write_bytes(b"")
    require_refused(path, KnowledgeCode.NO_SQLITE_FILE)


def test_open_places_without_a_file_are_refused(tmp_path: Path) -> None:
    require_refused(tmp_path, KnowledgeCode.NOT_A_FILE)
    (tmp_path / "loop").symlink_to("loop")
    os.mkfifo(tmp_path / "pipe")
    for place, code in {
        "loop": KnowledgeCode.UNREADABLE,
        "pipe": KnowledgeCode.NOT_A_FILE,
        "no folder/knowledge.db": KnowledgeCode.FOLDER_NOT_LOCKABLE,
    }.items():
        with refused(code):
            Journal.open(tmp_path / place, BINDING)
    with refused(KnowledgeCode.UNREADABLE):
        Journal.read_only(tmp_path / "knowledge.db")


def test_open_other_format_is_refused(path: Path) -> None:
    tamper(begun(path), "PRAGMA user_version = 2")
    require_refused(path, KnowledgeCode.OTHER_FORMAT, version=2, allowed=1)


def test_open_other_features_are_refused_with_difference(path: Path) -> None:
    names = ("s1", "s2", "minimum front", "wheel speed left")
    other = replace(BINDING, feature_hash="fedcba9876543210", feature_names=names)
    error = require_refused(begun(path), KnowledgeCode.OTHER_FEATURES, other)
    assert only_in(error) == [("file", "'maximum front'"), ("robot", "'minimum front'")]


def test_open_missing_level_is_added_and_extra_level_kept(path: Path) -> None:
    with Journal.open(begun(path), WITH_CRITIC) as journal:
        assert journal.binding == WITH_CRITIC
        journal.append([JournalEntry(appraisal(4), STAMP)])
    with Journal.open(path, BINDING) as journal:  # a robot without a critic
        assert journal.binding == WITH_CRITIC
        assert fold_journal(journal, radius=1.0).rlas_at(CRITIC) == (appraisal(4).rla,)
        assert check_knowledge(journal) == []


@pytest.mark.parametrize("event", [appraisal(1), SituationNamed("door", (1.0,), MID, origin("name-1", 9))])
def test_check_event_of_an_unknown_level_is_found(path: Path, event: TeachingEvent) -> None:
    with Journal.open(path, BINDING) as journal:
        journal.append([JournalEntry(event, STAMP)])
        (error,) = check_knowledge(journal)

    assert (error.code, error.where) == (KnowledgeCode.LESSON_MISFIT, f"{path}: row 1")


def test_open_other_task_is_refused_other_robot_is_not(path: Path) -> None:
    other = replace(BINDING, system="door passing")
    require_refused(begun(path), KnowledgeCode.OTHER_TASK, other, wanted="door passing")
    with Journal.open(path, replace(BINDING, robot="kurt2-in-simulation")) as journal:
        assert journal.binding.robot == "kurt2"


def test_open_second_writer_is_refused(path: Path) -> None:
    with Journal.open(path, BINDING), refused(KnowledgeCode.ANOTHER_WRITER):
        Journal.open(path, BINDING)
    Journal.open(path, BINDING).close()


def test_log_lessons_survive_a_crash(tmp_path: Path, path: Path) -> None:
    crashed = tmp_path / "crashed"
    crashed.mkdir()
    with Journal.open(path, BINDING) as journal:
        journal.append([entry(1), entry(2)])
        for file in contents(tmp_path):
            shutil.copy(tmp_path / file, crashed)  # as the disk is when the power goes

    assert (crashed / "knowledge.db-wal").stat().st_size > 0
    with Journal.read_only(crashed / path.name) as look:
        assert look.events() == [created(1), created(2)]
    with Journal.open(crashed / path.name, BINDING) as again:
        assert again.events() == [created(1), created(2)]


def test_log_truncated_keeps_acknowledged_lessons(tmp_path: Path, path: Path) -> None:
    crashed = tmp_path / "crashed"
    crashed.mkdir()
    with Journal.open(path, BINDING) as journal:
        journal.append([entry(1)])
        acknowledged = len(path.with_name("knowledge.db-wal").read_bytes())
        journal.append([entry(2)])
        shutil.copy(path, crashed)
        log = path.with_name("knowledge.db-wal").read_bytes()
    for length in range(acknowledged, len(log), 997):
        (crashed / "knowledge.db-wal").write_bytes(log[:length])
        with Journal.read_only(crashed / path.name) as look:
            assert look.events() == [created(1)]
            assert look.check() == []


def test_open_log_of_a_lost_file_is_refused(tmp_path: Path, path: Path) -> None:
    lost = tmp_path / "lost" / path.name
    lost.parent.mkdir()
    with Journal.open(path, BINDING) as journal:
        journal.append([entry(1)])
        shutil.copy(path.with_name("knowledge.db-wal"), lost.parent)

    require_refused(lost, KnowledgeCode.FILE_GONE, log="knowledge.db-wal")


def test_check_damaged_rows_are_named(path: Path) -> None:
    tamper(
        begun(path, lessons=5),
        "DROP TRIGGER lesson_stands",
        "DROP TRIGGER lesson_stays",
        "UPDATE lesson SET event = replace(event, '81.0', '91.0') WHERE sequence = 1",
        "UPDATE lesson SET event = CAST(x'7bff7d' AS TEXT) WHERE sequence = 2",
        "UPDATE lesson SET command_id = 'create-9' WHERE sequence = 3",
        "DELETE FROM lesson WHERE sequence = 4",
    )
    with Journal.read_only(path) as journal:
        found = check_knowledge(journal)
        with refused(KnowledgeCode.ROW_CHANGED, f"{path}: row 1"):
            journal.events()

    assert [(error.where, error.code) for error in found] == [
        (f"{path}: row 1", KnowledgeCode.ROW_CHANGED),
        (f"{path}: row 2", KnowledgeCode.NOT_AN_EVENT),
        (f"{path}: row 3", KnowledgeCode.ROW_CHANGED),
        (f"{path}: row 5", KnowledgeCode.ROW_MISPLACED),
    ]


def errors(path: Path) -> list[KnowledgeError]:
    """Return all that `knowledge check` finds."""
    try:
        with Journal.read_only(path) as journal:
            return check_knowledge(journal)
    except KnowledgeError as error:
        return [error]


def test_check_each_overwritten_page_is_found(path: Path) -> None:
    whole = begun(path, lessons=40).read_bytes()
    for page in range(1, len(whole) // 4096):
        path.write_bytes(whole[: page * 4096] + b"\xa5" * 4096 + whole[(page + 1) * 4096 :])
        assert errors(path) != []


def test_open_for_teaching_has_lessons_stamps_and_counts(path: Path) -> None:
    task = short_task()
    with open_knowledge(path, ROBOT, task) as journal:
        assert journal.binding.system == task.name
        assert journal.binding.levels == {CRITIC: load_critic(task.critic).level_features}
        lessons = [
            RlaCreated(Rla(number, (0.0,) * len(journal.binding.feature_names), "forward", None, origin(f"c{number}")))
            for number in (1, 2)
        ]
        journal.append([JournalEntry(lesson, f"stamp {lesson.rla.rla_id}") for lesson in lessons])
        saved = Statistics({1: 5}, {(1, 2): 3}, {1: 0.25}, {BEST_SCORE: 90.0})
        journal.checkpoint(saved)

    opened = open_for_teaching(path, ROBOT, task)
    with opened.journal as journal:
        assert opened.events == journal.events() == lessons
        assert opened.stamps == {"c1": "stamp 1", "c2": "stamp 2"}
        assert len(opened.entries) == 2
        assert (opened.counter.uses, opened.counter.transitions) == ({1: 5}, {(1, 2): 3})
        assert opened.saved == saved


def test_open_for_teaching_misfit_lesson_frees_the_lock(path: Path) -> None:
    task = short_task()
    with open_knowledge(path, ROBOT, task) as journal:
        journal.append([JournalEntry(undone("create-1"), STAMP)])
    for _ in range(2):
        with refused(KnowledgeCode.LESSON_MISFIT, f"{path}: row 1"):
            open_for_teaching(path, ROBOT, task)


def test_open_damaged_level_binding_is_refused(path: Path) -> None:
    Journal.open(path, WITH_CRITIC).close()
    tamper(path, "DELETE FROM binding WHERE key = 'level critic feature_names'")
    error = "KeyError('level critic feature_names')"
    require_refused(path, KnowledgeCode.BINDING_DAMAGED, WITH_CRITIC, error=error)


def test_read_knowledge_while_written_is_of_one_moment(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    task = short_task()
    with open_knowledge(path, ROBOT, task) as journal:
        zeros = (0.0,) * len(journal.binding.feature_names)
        first, second = (RlaCreated(replace(created(number).rla, condition=zeros)) for number in (1, 2))
        journal.append([JournalEntry(first, STAMP)], Statistics({1: 1}))

        def taught_meanwhile(look: Journal) -> Iterator[JournalEntry]:
            yield from iter_entries(look)
            journal.append([JournalEntry(second, STAMP)], Statistics({1: 2, 2: 1}))

        iter_entries = Journal.iter_entries
        with monkeypatch.context() as meanwhile:
            meanwhile.setattr(Journal, "iter_entries", taught_meanwhile)
            assert read_knowledge(path, ROBOT, task) == ([first], Statistics({1: 1}))
    assert read_knowledge(path, ROBOT, task) == ([first, second], Statistics({1: 2, 2: 1}))
