"""Merge of a branch: once, all or nothing, and conflicts are reported."""

import math
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kurt2rt.core.rla.credit import Credit
from kurt2rt.core.rla.event_error import InvalidEventError
from kurt2rt.core.rla.events import (
    KnowledgeMerged,
    LessonRedone,
    RlaCreated,
    RlaRewarded,
    SituationNamed,
    TeachingEvent,
)
from kurt2rt.core.rla.expectation import Expectation, pack
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.space import Space
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.fold import check_knowledge, fold_journal
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.knowledge.versions.branch import branch
from kurt2rt.knowledge.versions.contradictions import Radii
from kurt2rt.knowledge.versions.diff import compare
from kurt2rt.knowledge.versions.lesson_identity import NO_STACK, LessonKey, read_content
from kurt2rt.knowledge.versions.merge import Conflict, ConflictCode, MergePlan, RlaState, Side, merge
from kurt2rt.knowledge.versions.merge_writer import LeftOutCode
from tests.examples import examples
from tests.knowledge.journal.test_writer import largest_file
from tests.knowledge.lessons import (
    BINDING,
    STAMP,
    WITH_CRITIC,
    append,
    begun,
    created,
    deleted,
    origin,
    replaced,
    rewarded,
    session,
    undone,
)
from tests.knowledge.refusals import refused

BORDERS = Radii({BASIC: Space(4, 10.0)}, {BASIC: 0.2})
FAR = 1000.0


def at(rla_id: int, x: float, action: str = "forward", command_id: str | None = None) -> RlaCreated:
    """Return the creation of an RLA in one dimension."""
    event = created(rla_id, command_id, action)
    return RlaCreated(replace(event.rla, condition=(x, 0.0, 0.0, 0.0)))


@pytest.fixture
def mine(path: Path) -> Path:
    return begun(path)


@pytest.fixture
def theirs(mine: Path, tmp_path: Path) -> Path:
    branch(mine, tmp_path / "branch.knowledge", None, stamp=STAMP)
    return tmp_path / "branch.knowledge"


def states(conflict: Conflict) -> list[tuple[int | None, str | None]]:
    """Return the id of the RLA and its action, if it lives, in mine and in theirs."""
    found = list[tuple[int | None, str | None]]()
    for state in (conflict.mine, conflict.theirs):
        assert isinstance(state, RlaState)
        found.append((state.rla_id, None if state.rla is None else state.rla.action))
    return found


def merge_files(mine: Path, theirs: Path, prefer: Side | None = None, *, dry_run: bool = False) -> MergePlan:
    return merge(mine, theirs, BORDERS, prefer, teacher="command line", stamp=STAMP, dry_run=dry_run)


def folded(path: Path) -> RlaSystem:
    with Journal.read_only(path) as journal:
        assert check_knowledge(journal) == []
        return fold_journal(journal, radius=math.inf)


def actions(path: Path) -> dict[int, str]:
    return {rla.rla_id: rla.action for rla in folded(path).rlas}


def events(path: Path) -> list[TeachingEvent]:
    with Journal.read_only(path) as journal:
        return journal.events()


def the_same(one: Path, other: Path) -> bool:
    with Journal.read_only(one) as a, Journal.read_only(other) as b:
        return compare(read_content(a), read_content(b)).is_empty


def test_merge_new_lessons_get_ids_and_keep_teachers(mine: Path, theirs: Path) -> None:
    append(mine, at(4, FAR, "left", "mine-4"))
    append(theirs, at(4, 2 * FAR, "right", "theirs-4"), replaced(4, "back", "right"), replaced(2, "left", "forward"))
    merged = merge_files(mine, theirs)
    assert (merged.lessons, merged.undone, merged.redone, merged.conflicts) == (3, 0, 0, ())
    assert merged.new_ids == {4: 5}
    assert actions(mine) == {1: "forward", 2: "left", 3: "forward", 4: "left", 5: "back"}
    *_, last = events(mine)
    assert isinstance(last, KnowledgeMerged)
    assert (last.source, last.rows, last.last) == ("branch.knowledge", 6, "replace-2-left")
    record = folded(mine).lesson("replace-4-back")
    assert record is not None
    assert record.event.origin.teacher == "Hertha"


def test_merge_again_brings_only_later_lessons(mine: Path, theirs: Path) -> None:
    append(theirs, at(4, FAR, "left", "theirs-4"), *session(100))
    merge_files(mine, theirs)
    once = events(mine)
    again = merge_files(mine, theirs)
    assert events(mine) == once
    assert (again.entries, again.lessons) == ((), 0)
    append(theirs, replaced(4, "back", "left"), undone("create-3"))
    merge_files(mine, theirs)
    assert actions(mine) == {1: "forward", 2: "forward", 4: "back"}
    assert folded(mine).teaching_ticks == 100
    assert the_same(mine, theirs)


def test_merge_both_ways_makes_files_equal(mine: Path, theirs: Path) -> None:
    append(mine, at(4, FAR, "left", "mine-4"), deleted(1))
    append(theirs, at(4, 2 * FAR, "right", "theirs-4"))
    merge_files(mine, theirs)
    merge_files(theirs, mine)
    assert the_same(mine, theirs)
    assert actions(theirs) == {2: "forward", 3: "forward", 4: "right", 5: "left"}


def test_merge_undo_and_redo_there_follow_here(mine: Path, theirs: Path) -> None:
    append(theirs, undone("create-2"))
    assert merge_files(mine, theirs).undone == 1
    assert actions(mine) == {1: "forward", 3: "forward"}
    append(theirs, LessonRedone("create-2", origin("redo-2")))
    assert merge_files(mine, theirs).redone == 1
    assert actions(mine) == {1: "forward", 2: "forward", 3: "forward"}


def test_merge_lessons_undone_there_are_not_brought(mine: Path, theirs: Path) -> None:
    append(theirs, at(4, FAR), undone("create-4"), rewarded(1, 1, "praise"), undone("praise"))
    assert merge_files(mine, theirs).entries == ()


@pytest.mark.parametrize(("prefer", "action"), [(None, "left"), ("mine", "left"), ("theirs", "right")])
def test_merge_rla_changed_in_both_is_a_conflict(mine: Path, theirs: Path, prefer: Side | None, action: str) -> None:
    append(mine, replaced(2, "left", "forward"))
    append(theirs, replaced(2, "right", "forward"), at(4, FAR, command_id="theirs-4"))
    before = events(mine)
    merged = merge_files(mine, theirs, prefer)
    (conflict,) = merged.conflicts
    assert states(conflict) == [(2, "left"), (2, "right")]
    assert actions(mine)[2] == action
    if prefer is None:
        assert events(mine) == before
    else:
        assert actions(mine)[4] == "forward"
        assert merge_files(mine, theirs).conflicts == ()  # settled once


def test_merge_equal_changes_are_no_conflict(mine: Path, theirs: Path) -> None:
    append(mine, replaced(2, "left", "forward"))
    append(theirs, replaced(2, "right", "forward"), replaced(2, "left", "right"))
    append(mine, deleted(3))
    append(theirs, undone("create-3"))
    assert merge_files(mine, theirs).conflicts == ()
    assert actions(mine) == {1: "forward", 2: "left"}


@pytest.mark.parametrize("prefer", [None, "mine", "theirs"])
def test_merge_near_rlas_of_other_action_are_a_conflict(mine: Path, theirs: Path, prefer: Side | None) -> None:
    append(mine, at(4, FAR, "left", "mine-4"))
    append(theirs, at(4, FAR + 2.0, "right", "theirs-4"), at(5, FAR + 2.1, "right", "theirs-5"))
    (conflict,) = merge_files(mine, theirs, prefer).conflicts
    assert states(conflict) == [(4, "left"), (4, "right")]
    assert conflict.code is ConflictCode.NEAR
    assert conflict.distance == pytest.approx(2.0)
    assert conflict.radius_fraction == 0.2
    settled = {None: {4: "left"}, "mine": {4: "left", 5: "right"}, "theirs": {5: "right", 6: "right"}}[prefer]
    assert {rla_id: action for rla_id, action in actions(mine).items() if rla_id > 3} == settled


def test_merge_correction_near_an_rla_of_mine_is_no_conflict(mine: Path, theirs: Path) -> None:
    append(mine, RlaCreated(replace(created(4, "mine-4", "left").rla, condition=(*created(2).rla.condition[:3], -4.9))))
    append(theirs, replaced(2, "right", "forward"))
    assert merge_files(mine, theirs).conflicts == ()
    assert actions(mine) == {1: "forward", 2: "right", 3: "forward", 4: "left"}


def test_free_command_id_appends_checksum_then_number() -> None:
    key = LessonKey("teach", 0xAB, NO_STACK, is_reward=False)
    taken = set[str]()
    for expected in ("teach", "teach~000000ab", "teach~000000ab-2", "teach~000000ab-3"):
        assert key.free_command_id(taken) == expected
        taken.add(expected)


def test_merge_alternatives_to_known_rlas_are_no_conflict(mine: Path, theirs: Path) -> None:
    first = created(1).rla.condition
    alternative = RlaCreated(replace(created(4, "theirs-4", "left").rla, condition=first))
    append(theirs, alternative)
    assert merge_files(mine, theirs).conflicts == ()
    second = RlaCreated(replace(created(5, "theirs-5", "right").rla, condition=created(2).rla.condition))
    append(theirs, deleted(2), second)
    assert merge_files(mine, theirs).conflicts == ()
    assert actions(mine) == {1: "forward", 3: "forward", 4: "left", 5: "right"}


def test_merge_rewards_of_both_add_up(mine: Path, theirs: Path) -> None:
    append(mine, rewarded(1, 1, "mine"))
    blame = RlaRewarded(1, -1, 390, origin("theirs"), (Credit(1, -0.5), Credit(4, -0.25), Credit(9, -1.0)))
    append(theirs, at(4, FAR, command_id="theirs-4"), blame, replaced(1, "left", "forward"))
    append(mine, at(4, -FAR, command_id="mine-4"))
    merge_files(mine, theirs)
    system = folded(mine)
    assert system.appraisal(1) == (1, 1)
    assert actions(mine)[1] == "left"
    record = system.lesson("theirs")
    assert record is not None
    assert isinstance(record.event, RlaRewarded)
    assert record.event.credits == (Credit(1, -0.5), Credit(5, -0.25))  # the ninth RLA exists in neither file
    assert merge_files(mine, theirs).entries == ()


def test_merge_name_of_two_situations_is_a_conflict(mine: Path, theirs: Path) -> None:
    for path, x in ((mine, 1.0), (theirs, 2.0)):
        append(path, SituationNamed("door", (x, 0.0, 0.0, 0.0), BASIC, origin(f"name-{x}")))
    (conflict,) = merge_files(mine, theirs).conflicts
    assert conflict.code is ConflictCode.OTHER_SITUATION
    merge_files(mine, theirs, "theirs")
    assert folded(mine).named_situations(BASIC)["door"][0] == 2.0


def test_merge_unrelated_files_with_equal_ids(mine: Path, tmp_path: Path) -> None:
    stranger = tmp_path / "stranger"
    append(stranger, *(at(number, FAR * number, "left", f"create-{number}") for number in (1, 2)))
    append(stranger, replaced(2, "back", "left"))
    merge_files(mine, stranger)
    assert actions(mine) == {1: "forward", 2: "forward", 3: "forward", 4: "left", 5: "back"}
    once = events(mine)
    merge_files(mine, stranger)
    assert events(mine) == once


def test_merge_new_rlas_bring_their_counts(mine: Path, theirs: Path) -> None:
    append(mine, at(4, -FAR, command_id="mine-4"))
    append(theirs, at(4, FAR, command_id="theirs-4"))
    expected = Expectation("theirs-4", 3, 10.0, pack(np.ones(4)), pack(np.zeros(4)))
    for path in (mine, theirs):
        with Journal.open(path, BINDING) as journal:
            journal.checkpoint(Statistics({1: 9, 4: 5}, {(1, 4): 3, (1, 2): 8}, expectations={4: expected}))
    merge_files(mine, theirs)
    with Journal.read_only(mine) as journal:
        counted = journal.statistics()
    assert counted.uses == {1: 9, 4: 5, 5: 5}
    assert counted.transitions == {(1, 4): 3, (1, 5): 3, (1, 2): 8}
    assert counted.expectations == {4: expected, 5: expected}


def test_merge_refused_or_dry_run_changes_nothing(mine: Path, theirs: Path, tmp_path: Path) -> None:
    append(theirs, at(4, FAR))
    before = events(mine)
    with Journal.open(mine, BINDING), refused(KnowledgeCode.ANOTHER_WRITER):
        merge_files(mine, theirs)
    assert merge_files(mine, theirs, dry_run=True).lessons == 1
    Journal.open(tmp_path / "other", replace(BINDING, feature_hash="another")).close()
    with refused(KnowledgeCode.OTHER_FEATURES):
        merge_files(mine, tmp_path / "other")
    assert events(mine) == before


def test_merge_full_disk_writes_all_or_nothing(mine: Path, theirs: Path) -> None:
    append(theirs, *(at(number, FAR * number, command_id=f"theirs-{number}") for number in range(4, 40)))
    before = events(mine)
    failed = 0
    for room in range(0, 80_000, 4_000):
        with largest_file(room):
            try:
                merge_files(mine, theirs)
            except KnowledgeError:
                failed += 1
        assert len(events(mine)) in (len(before), len(before) + 37)
    assert failed
    merge_files(mine, theirs)
    assert the_same(mine, theirs)


def both_taught(mine: Path, theirs: Path) -> None:
    """One lesson in each since they parted, so that what comes here has another number there; then merged there."""
    append(mine, at(4, FAR, "left", "mine-4"))
    append(theirs, at(4, -FAR, "right", "theirs-4"))
    merge_files(theirs, mine)
    assert actions(theirs) == {1: "forward", 2: "forward", 3: "forward", 4: "right", 5: "left"}


def test_merge_undo_here_outlives_their_copy(mine: Path, theirs: Path) -> None:
    both_taught(mine, theirs)
    append(mine, undone("mine-4"))
    merged = merge_files(mine, theirs)
    assert (merged.lessons, merged.redone, merged.conflicts) == (1, 0, ())
    assert actions(mine) == {1: "forward", 2: "forward", 3: "forward", 5: "right"}
    merge_files(theirs, mine)
    assert the_same(mine, theirs)


def test_merge_undo_of_a_merged_lesson_follows_here(mine: Path, theirs: Path) -> None:
    both_taught(mine, theirs)
    append(theirs, undone("mine-4"))
    assert merge_files(mine, theirs).undone == 1
    assert the_same(mine, theirs)


def test_merge_correction_of_a_merged_lesson_follows_here(mine: Path, theirs: Path) -> None:
    both_taught(mine, theirs)
    append(theirs, replaced(5, "back", "left"))
    assert merge_files(mine, theirs).conflicts == ()
    assert actions(mine)[4] == "back"
    assert the_same(mine, theirs)


def test_merge_undo_after_a_third_file_is_a_conflict(mine: Path, theirs: Path, tmp_path: Path) -> None:
    third = tmp_path / "third"
    branch(mine, third, None, stamp=STAMP)
    append(mine, at(4, FAR, "left", "mine-4"))
    append(theirs, at(4, -FAR, "right", "theirs-4"))
    merge_files(third, mine)
    merge_files(theirs, third)
    append(mine, undone("mine-4"))
    (conflict,) = merge_files(mine, theirs).conflicts
    assert states(conflict) == [(4, None), (5, "left")]
    assert 4 not in actions(mine)


def test_merge_two_bases_change_of_both_is_a_conflict(mine: Path, theirs: Path, tmp_path: Path) -> None:
    append(mine, at(4, FAR, "left", "mine-4"))
    append(theirs, at(4, -FAR, "right", "theirs-4"))
    older = tmp_path / "older" / "branch.knowledge"
    branch(theirs, older, None, stamp=STAMP)
    merge_files(theirs, mine)
    merge_files(mine, older)
    assert the_same(mine, theirs)
    append(theirs, undone("mine-4"))
    append(mine, replaced(4, "back", "left"))
    assert len(merge_files(mine, theirs).conflicts) == 1


def test_merge_reward_follows_though_an_older_is_undone(mine: Path, tmp_path: Path) -> None:
    append(mine, rewarded(1, 1, "old"))
    branch(mine, tmp_path / "new", None, stamp=STAMP)
    append(mine, undone("old"))
    append(tmp_path / "new", rewarded(1, -1, "blame"))
    merge_files(mine, tmp_path / "new")
    assert folded(mine).appraisal(1) == (0, 1)


def test_merge_reward_undone_there_leaves_newer_reward(mine: Path, tmp_path: Path) -> None:
    append(mine, rewarded(1, 1, "old"))
    theirs = tmp_path / "new"
    branch(mine, theirs, None, stamp=STAMP)
    append(mine, rewarded(1, -1, "blame"))
    append(theirs, undone("old"))
    merged = merge_files(mine, theirs)
    assert (merged.lessons, merged.undone, merged.redone) == (0, 1, 0)
    assert folded(mine).appraisal(1) == (0, 1)
    merge_files(theirs, mine)
    assert the_same(mine, theirs)


def test_merge_buried_reward_stays_and_is_reported(mine: Path, tmp_path: Path) -> None:
    append(mine, rewarded(1, 1, "old"))
    theirs = tmp_path / "new"
    branch(mine, theirs, None, stamp=STAMP)
    append(mine, replaced(1, "left", "forward"))
    append(theirs, undone("old"))
    (reward,) = merge_files(mine, theirs).left_out
    assert (reward.code, reward.record.event) == (LeftOutCode.BURIED, rewarded(1, 1, "old"))
    assert merge_files(mine, theirs).left_out == ()


def test_merge_reward_of_another_action_is_left_out(mine: Path, theirs: Path) -> None:
    append(mine, replaced(1, "left", "forward"))
    of_another = RlaRewarded(2, -1, 390, origin("of-2"), (Credit(2, -0.5), Credit(1, -0.25)))
    append(theirs, rewarded(1, -1, "of-1"), of_another)
    merged = merge_files(mine, theirs)
    (reward,) = merged.left_out
    assert (reward.code, reward.action) == (LeftOutCode.OTHER_ACTION, "forward")
    assert reward.rla is not None
    assert reward.rla.action == "left"
    system = folded(mine)
    assert (system.appraisal(1), system.appraisal(2)) == ((0, 0), (0, 1))
    record = system.lesson("of-2")
    assert record is not None
    assert isinstance(record.event, RlaRewarded)
    assert record.event.credits == (Credit(2, -0.5),)
    assert merge_files(mine, theirs).left_out == ()


def test_merge_orphaned_reward_is_a_conflict(mine: Path, theirs: Path) -> None:
    append(theirs, replaced(1, "left", "forward"))
    merge_files(mine, theirs)
    append(mine, rewarded(1, 1, "praise"))
    append(theirs, undone("replace-1-left"))
    (conflict,) = merge_files(mine, theirs).conflicts
    assert conflict.code is ConflictCode.REWARDED_HERE
    merge_files(mine, theirs, "theirs")
    assert (actions(mine)[1], folded(mine).appraisal(1)) == ("forward", (0, 0))


def test_merge_plan_and_conflict_leave_bytes_unchanged(mine: Path, tmp_path: Path) -> None:
    theirs = tmp_path / "with-critic"
    with Journal.open(theirs, WITH_CRITIC) as journal:
        journal.append([JournalEntry(created(number), STAMP) for number in (1, 2, 3)])
        journal.append([JournalEntry(replaced(1, "left", "forward"), STAMP)])
    whole = mine.read_bytes()
    with Journal.open(mine, BINDING):
        assert merge_files(mine, theirs, dry_run=True).lessons == 1
    assert mine.read_bytes() == whole
    append(mine, replaced(1, "right", "forward"))
    whole = mine.read_bytes()
    assert len(merge_files(mine, theirs).conflicts) == 1
    assert mine.read_bytes() == whole


def test_merge_lesson_without_redo_comes_as_new(mine: Path, theirs: Path) -> None:
    append(mine, rewarded(1, 1, "praise"))
    append(theirs, replaced(1, "left", "forward"))
    merge_files(mine, theirs)
    append(mine, undone("replace-1-left"), undone("praise"))
    append(theirs, replaced(1, "right", "left"))
    assert len(merge_files(mine, theirs).conflicts) == 1
    merge_files(mine, theirs, "theirs")
    assert actions(mine)[1] == "right"
    merge_files(theirs, mine)
    assert the_same(mine, theirs)


def test_merge_equal_ids_both_ways_are_there_once(mine: Path, theirs: Path) -> None:
    append(mine, at(4, FAR, "left", "same"), *session(100))
    append(theirs, at(4, -FAR, "right", "same"), *session(20))
    merge_files(mine, theirs)
    merge_files(theirs, mine)
    assert the_same(mine, theirs)
    for path in (mine, theirs):
        assert sorted(actions(path).values()) == ["forward", "forward", "forward", "left", "right"]
        assert folded(path).teaching_ticks == 120


Step = tuple[int, int]
steps = st.lists(st.tuples(st.integers(0, 5), st.integers(0, 20)), max_size=12)


def teach(path: Path, whose: str, steps: Iterable[Step]) -> None:
    system = folded(path)
    taught = list[TeachingEvent]()
    for number, (what, which) in enumerate(steps):
        name = f"{whose}-{len(system.lessons)}-{number}"
        living = [rla.rla_id for rla in system.rlas]
        lessons = [record.event.origin.command_id for record in system.lessons]
        one = living[which % len(living)] if living else 0
        lesson = lessons[which % len(lessons)] if lessons else "nothing"
        event: TeachingEvent
        match what:
            case 0:
                event = at(system.next_id, which * FAR / 3 + number, f"a{which % 3}", name)
            case 1:
                event = replace(replaced(one, f"r{which % 3}", ""), origin=origin(name))
            case 2:
                event = replace(deleted(one), origin=origin(name))
            case 3:
                event = rewarded(one, 1, name)
            case 4:
                event = replace(undone(lesson), origin=origin(name))
            case _:
                event = LessonRedone(lesson, origin(name))
        try:
            system.apply(event)
        except InvalidEventError:
            continue
        taught.append(event)
    append(path, *taught)


@settings(examples(24), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(steps, steps, steps, st.sampled_from(["mine", "theirs"]))
def test_merge_random_files_fit_once_and_then_change_nothing(
    tmp_path_factory: pytest.TempPathFactory, first: list[Step], here: list[Step], there: list[Step], prefer: Side
) -> None:
    folder = tmp_path_factory.mktemp("merge")
    mine, theirs = begun(folder / "mine"), folder / "theirs"
    teach(mine, "both", first)
    branch(mine, theirs, None, stamp=STAMP)
    teach(mine, "mine", here)
    teach(theirs, "theirs", there)
    unchanged = events(theirs)
    merge_files(mine, theirs, prefer)
    folded(mine)
    once = events(mine)
    assert merge_files(mine, theirs).entries == ()
    assert events(mine) == once
    assert events(theirs) == unchanged
