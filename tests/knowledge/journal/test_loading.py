import os
import shutil
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest

from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.rla.feature_set import LevelFeatures
from kurt2rt.core.rla.rla import CRITIC, MID, Rla, RlaCreated, SituationNamed
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.journal.binding import KnowledgeBinding
from kurt2rt.knowledge.journal.entry import JournalEntry, StoredEntry
from kurt2rt.knowledge.journal.fold import check_knowledge, fold_journal
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import open_for_teaching, open_knowledge, read_knowledge
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from tests.experiments.helpers import ROBOT, short_task
from tests.knowledge.lessons import (
    BINDING,
    CIRCUMSTANCES,
    STAMP,
    WITH_CRITIC,
    appraisal,
    begun,
    created,
    entry,
    origin,
    rewarded,
    tamper,
    undone,
)


def contents(folder: Path) -> dict[str, bytes]:
    """All files of a folder but the empty ones of writers' locks."""
    return {each.name: each.read_bytes() for each in folder.iterdir() if each.is_file() and each.suffix != ".lock"}


def refusal(path: Path, binding: KnowledgeBinding = BINDING) -> str:
    """The one line with which a file is refused, after which every file is as it was."""
    before = contents(path.parent)
    with pytest.raises(KnowledgeError) as refused:
        Journal.open(path, binding)
    assert contents(path.parent) == before
    message = str(refused.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    assert "; " in message
    return message


def test_a_new_file_is_begun_where_there_was_none(path: Path) -> None:
    with Journal.open(path, BINDING) as journal:
        assert journal.events() == []
        assert journal.check() == []
    assert contents(path.parent).keys() == {"knowledge.db"}


def test_a_birth_that_a_crash_cut_short_does_not_matter(path: Path) -> None:
    path.with_name(".knowledge.db.unborn").write_bytes(b"SQLite format 3\x00 and then the battery was empty")

    assert Journal.read_only(begun(path)).events() == [created(1), created(2), created(3)]


def test_files_that_are_no_knowledge_are_refused_and_left_alone(path: Path) -> None:
    path.write_text("Dear diary,\n")
    assert "is not a knowledge file" in refusal(path)
    path.write_bytes(b"")
    assert "is not a knowledge file" in refusal(path)


def test_the_file_of_another_program_is_refused_and_left_alone(path: Path) -> None:
    tamper(path, "CREATE TABLE bookmark (url TEXT)")
    assert "is an SQLite file of another program" in refusal(path)


def test_places_that_hold_no_file(tmp_path: Path) -> None:
    assert "is a folder" in refusal(tmp_path)
    (tmp_path / "loop").symlink_to("loop")
    os.mkfifo(tmp_path / "pipe")
    for place, problem in {
        "loop": "cannot be read",
        "pipe": "is a folder or device",
        "no folder/knowledge.db": "give a path in a folder that exists",
    }.items():
        with pytest.raises(KnowledgeError, match=problem):
            Journal.open(tmp_path / place, BINDING)
    with pytest.raises(KnowledgeError, match=r"cannot be read .*; give the path"):
        Journal.read_only(tmp_path / "knowledge.db")


def test_a_newer_format_is_refused(path: Path) -> None:
    tamper(begun(path), "PRAGMA user_version = 2")
    assert "has format 2 of a newer kurt2rt" in refusal(path)


@pytest.mark.parametrize(
    ("names", "difference"),
    [
        (
            ("s1", "s2", "minimum front", "wheel speed left"),
            "only the file has 'maximum front', only the robot has 'min",
        ),
        (("s1", "s2", "maximum front"), "only the file has 'wheel speed left'"),
        ((*BINDING.feature_names, *"abcdef"), "only the robot has 'a', 'b', 'c', 'd' and 2 more"),
        (("s2", "s1", "maximum front", "wheel speed left"), "the same names in another order"),
        (BINDING.feature_names, "scales, history or the robot's sensor order differ"),
    ],
)
def test_knowledge_of_other_features_is_refused_and_the_difference_named(
    path: Path, names: tuple[str, ...], difference: str
) -> None:
    other = replace(BINDING, feature_hash="fedcba9876543210", feature_names=names)

    message = refusal(begun(path), other)

    assert "taught with other features: " in message
    assert difference in message


def test_a_level_that_a_file_lacks_is_added_and_one_that_the_robot_lacks_is_left_alone(path: Path) -> None:
    with Journal.open(begun(path), WITH_CRITIC) as journal:
        assert journal.binding == WITH_CRITIC
        journal.append([JournalEntry(appraisal(4), STAMP)])
    with Journal.open(path, BINDING) as journal:  # a robot without a critic
        assert journal.binding == WITH_CRITIC
        assert fold_journal(journal, radius=1.0).rlas_at(CRITIC) == (appraisal(4).rla,)
        assert check_knowledge(journal) == []


@pytest.mark.parametrize(
    ("features", "difference"),
    [
        (LevelFeatures("0", ("left_m", "speed_m_s", "bump")), "only the file has 'bumped', only the robot has 'bump'"),
        (
            LevelFeatures("0", CIRCUMSTANCES.feature_names),
            "the names are the same, but what they are made from differs",
        ),
        (LevelFeatures("fedcba", CIRCUMSTANCES.feature_names[::-1]), "the same names in another order"),
    ],
)
def test_a_level_of_other_features_is_refused_and_the_difference_named(
    path: Path, features: LevelFeatures, difference: str
) -> None:
    with Journal.open(path, WITH_CRITIC) as journal:
        journal.append([JournalEntry(appraisal(1), STAMP)])

    message = refusal(path, replace(BINDING, levels={CRITIC: features}))

    assert "its level critic was taught with other features: " in message
    assert difference in message
    assert message.endswith("use the critic settings it was taught with, or give another knowledge file")


def test_a_level_that_nothing_was_taught_at_is_bound_anew(path: Path) -> None:
    Journal.open(path, WITH_CRITIC).close()
    other = replace(BINDING, levels={CRITIC: LevelFeatures("0", ("left_m", "speed_m_s"))})
    with Journal.open(path, other) as journal:
        assert journal.binding == other
        journal.append([JournalEntry(appraisal(1, (0.4, 0.2)), STAMP)])
    assert "its level critic was taught with other features: " in refusal(path, WITH_CRITIC)


def test_an_rla_of_a_level_that_the_file_does_not_know_is_found(path: Path) -> None:
    with Journal.open(path, BINDING) as journal:
        journal.append([JournalEntry(appraisal(1), STAMP)])
        (problem,) = check_knowledge(journal)

    assert "row 1: does not fit the lessons before it: appraisal RLA 1 is of the level 'critic', of which" in problem


def test_a_name_given_at_a_level_that_the_file_does_not_know_is_found(path: Path) -> None:
    with Journal.open(path, BINDING) as journal:
        journal.append([JournalEntry(SituationNamed("door", (1.0,), MID, origin("name-1", 9)), STAMP)])
        (problem,) = check_knowledge(journal)

    assert "row 1: does not fit the lessons before it: the situation 'door' is of the level 'mid', of which" in problem


def test_knowledge_of_another_task_is_refused_but_not_that_of_another_robot(path: Path) -> None:
    assert "not for 'door passing'" in refusal(begun(path), replace(BINDING, system="door passing"))
    with Journal.open(path, replace(BINDING, robot="kurt2-in-simulation")) as journal:
        assert journal.binding.robot == "kurt2"


def test_only_one_robot_writes_a_file(path: Path) -> None:
    refused = pytest.raises(KnowledgeError, match=r"another kurt2rt is writing it .*; stop that one")
    with Journal.open(path, BINDING), refused:
        Journal.open(path, BINDING)
    Journal.open(path, BINDING).close()


def test_lessons_in_the_log_survive_a_crash_and_a_look(tmp_path: Path, path: Path) -> None:
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


def test_a_torn_log_costs_only_what_was_never_acknowledged(tmp_path: Path, path: Path) -> None:
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


def test_the_log_of_a_lost_file_is_not_mixed_into_a_new_one(tmp_path: Path, path: Path) -> None:
    lost = tmp_path / "lost" / path.name
    lost.parent.mkdir()
    with Journal.open(path, BINDING) as journal:
        journal.append([entry(1)])
        shutil.copy(path.with_name("knowledge.db-wal"), lost.parent)

    assert "its log knowledge.db-wal is still there and may hold lessons" in refusal(lost)


def test_damage_is_found_and_its_row_named(path: Path) -> None:
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
        with pytest.raises(KnowledgeError, match=rf"^{path}: row 1: was changed after it was written"):
            journal.events()

    assert [line.removeprefix(f"{path}: ").split(";")[0] for line in found] == [
        "row 1: was changed after it was written (checksum)",
        "row 2: not a teaching event: Expecting property name enclosed in double quotes: line 1 column 2 (char 1)",
        "row 3: was changed after it was written (checksum)",
        "row 5: stands where row 4 should",
    ]


def problems(path: Path) -> list[str]:
    """All that `knowledge check` would say."""
    try:
        with Journal.read_only(path) as journal:
            return check_knowledge(journal)
    except KnowledgeError as error:
        return [str(error)]


def test_no_page_of_rubble_goes_unseen(path: Path) -> None:
    whole = begun(path, lessons=40).read_bytes()
    for page in range(1, len(whole) // 4096):
        path.write_bytes(whole[: page * 4096] + b"\xa5" * 4096 + whole[(page + 1) * 4096 :])
        assert problems(path) != []


def test_lessons_that_do_not_fit_together_are_found(path: Path) -> None:
    with Journal.open(path, BINDING) as journal:
        journal.append([entry(2), entry(1)])
        (problem,) = check_knowledge(journal)

    assert problem.startswith(f"{path}: row 2: does not fit the lessons before it: RLA 1 cannot be created")


def test_an_undo_that_does_not_fit_is_found(path: Path) -> None:
    with Journal.open(path, BINDING) as journal:
        journal.append([entry(1), *(JournalEntry(event, STAMP) for event in (rewarded(1), undone("create-1")))])
        (problem,) = check_knowledge(journal)

    assert problem.startswith(
        f"{path}: row 3: does not fit the lessons before it: lesson 'reward-1' came after 'create-1' (RLA 1 rewarded)"
    )


def test_teaching_goes_on_from_what_is_there_and_from_when_it_was_taught(path: Path) -> None:
    task = short_task()
    with open_knowledge(path, ROBOT, task) as journal:
        assert journal.binding.system == task.name
        assert journal.binding.levels == {CRITIC: load_critic(task.critic).level_features}
        lessons = [
            RlaCreated(Rla(number, (0.0,) * len(journal.binding.feature_names), "forward", None, origin(f"c{number}")))
            for number in (1, 2)
        ]
        journal.append([JournalEntry(lesson, f"stamp {lesson.rla.rla_id}") for lesson in lessons])
        saved = Statistics({1: 5}, {(1, 2): 3}, {1: 0.25}, {(1, 2): 90.0})
        journal.checkpoint(saved)

    opened = open_for_teaching(path, ROBOT, task)
    with opened.journal as journal:
        assert opened.events == journal.events() == lessons
        assert opened.stamps == {"c1": "stamp 1", "c2": "stamp 2"}
        assert [stored.sequence for stored in opened.entries] == [1, 2]
        assert (opened.counter.uses, opened.counter.transitions) == ({1: 5}, {(1, 2): 3})
        assert opened.saved == saved


def test_lessons_that_do_not_fit_together_are_not_taught_on_with_and_the_file_is_free_again(path: Path) -> None:
    task = short_task()
    with open_knowledge(path, ROBOT, task) as journal:
        journal.append([JournalEntry(undone("create-1"), STAMP)])
    for _ in range(2):
        with pytest.raises(KnowledgeError, match=r"row 1: does not fit .*: there is no lesson 'create-1'; keep the"):
            open_for_teaching(path, ROBOT, task)


def test_a_damaged_binding_is_refused(path: Path) -> None:
    with closing(sqlite3.connect(begun(path))) as connection, connection:
        connection.execute("DELETE FROM binding WHERE key = 'system'")
    assert "table binding is damaged (KeyError('system'))" in refusal(path)


def test_a_damaged_binding_of_a_level_is_refused(path: Path) -> None:
    Journal.open(path, WITH_CRITIC).close()
    tamper(path, "DELETE FROM binding WHERE key = 'level critic feature_names'")
    assert "table binding is damaged (KeyError('level critic feature_names'))" in refusal(path, WITH_CRITIC)


def test_lessons_and_counts_of_a_robot_that_runs_are_of_one_moment(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    task = short_task()
    with open_knowledge(path, ROBOT, task) as journal:
        zeros = (0.0,) * len(journal.binding.feature_names)
        first, second = (RlaCreated(replace(created(number).rla, condition=zeros)) for number in (1, 2))
        journal.append_and_checkpoint([JournalEntry(first, STAMP)], Statistics({1: 1}))

        def taught_meanwhile(look: Journal) -> Iterator[StoredEntry]:
            yield from iter_entries(look)
            journal.append_and_checkpoint([JournalEntry(second, STAMP)], Statistics({1: 2, 2: 1}))

        iter_entries = Journal.iter_entries
        with monkeypatch.context() as meanwhile:
            meanwhile.setattr(Journal, "iter_entries", taught_meanwhile)
            assert read_knowledge(path, ROBOT, task) == ([first], Statistics({1: 1}))
    assert read_knowledge(path, ROBOT, task) == ([first, second], Statistics({1: 2, 2: 1}))
