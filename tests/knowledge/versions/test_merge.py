"""Merge: lessons of another file are appended once, and undone together."""

import shutil
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kurt2rt.core.outcome import RefusalCode
from kurt2rt.core.rla.credit import Credit
from kurt2rt.core.rla.events import (
    InvalidEventError,
    LessonRedone,
    RlaCreated,
    RlaRewarded,
    SituationNamed,
    TeachingEvent,
)
from kurt2rt.core.rla.lesson_history import LessonRecord
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.core.rla.statistics import FIRST_VALUE, VALUES_INCLUDE, Statistics
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.knowledge.versions.lesson_identity import lesson_keys
from kurt2rt.knowledge.versions.merge import MergeResult, merge
from kurt2rt.knowledge.versions.undo import apply_plan, plan_redo, plan_undo
from tests.examples import examples
from tests.knowledge.journal.test_writer import largest_file
from tests.knowledge.lessons import (
    BINDING,
    STAMP,
    append,
    begun,
    created,
    deleted,
    origin,
    replaced,
    rewarded,
    undone,
    withdrawn,
)
from tests.knowledge.reading import folded
from tests.knowledge.refusals import refused

FAR = 1000.0


def at(rla_id: int, x: float, action: str = "forward", command_id: str | None = None) -> RlaCreated:
    """Return the creation of an RLA in one dimension."""
    event = created(rla_id, command_id, action)
    return RlaCreated(replace(event.rla, condition=(x, 0.0, 0.0, 0.0)))


def named(x: float, command_id: str) -> SituationNamed:
    return SituationNamed("door", (x, 0.0, 0.0, 0.0), BASIC, origin(command_id))


@pytest.fixture
def mine(path: Path) -> Path:
    return begun(path)


@pytest.fixture
def theirs(mine: Path, tmp_path: Path) -> Path:
    return Path(shutil.copy(mine, tmp_path / "theirs.knowledge"))


def actions(path: Path) -> dict[int, str]:
    return {rla.rla_id: rla.action for rla in folded(path).rlas}


def events(path: Path) -> list[TeachingEvent]:
    with Journal.read_only(path) as journal:
        return journal.events()


def left_out(merged: MergeResult) -> list[str]:
    return [record.event.origin.command_id for record in merged.left_out]


def brought(path: Path, merged: MergeResult) -> list[LessonRecord]:
    lessons = folded(path).history.records
    return [each for each in lessons if each.event.origin.command_id.startswith(f"{merged.merge_id}/")]


def test_merge_again_brings_only_later_lessons(mine: Path, theirs: Path) -> None:
    append(theirs, at(4, FAR, "left", "theirs-4"))
    merge(mine, theirs)
    once = mine.read_bytes()
    assert merge(mine, theirs).lessons == 0
    assert mine.read_bytes() == once
    append(theirs, replaced(4, "back", "left"))
    assert merge(mine, theirs).lessons == 1
    assert merge(theirs, mine).lessons == 0


def test_merge_lessons_undone_there_or_here_do_not_come(mine: Path, theirs: Path) -> None:
    append(theirs, at(4, FAR), undone("create-4"), rewarded(1, 1, "praise"), undone("praise"))
    append(mine, undone("create-2"))
    merged = merge(mine, theirs)
    assert (merged.lessons, merged.stay_undone, merged.left_out) == (0, 1, ())
    append(theirs, replaced(2, "left", "forward"))
    assert left_out(merge(mine, theirs)) == ["replace-2-left"]
    assert actions(mine) == {1: "forward", 3: "forward"}


def test_merge_lessons_that_find_another_state_are_left_out(mine: Path, theirs: Path) -> None:
    append(mine, replaced(2, "left", "forward"), deleted(3), named(1.0, "my-door"))
    unfit = (replaced(2, "right", "forward"), rewarded(2, -1, "blame"), withdrawn(3), named(2.0, "their-door"))
    append(theirs, *unfit, at(4, FAR, command_id="theirs-4"))
    merged = merge(mine, theirs)
    assert left_out(merged) == [each.origin.command_id for each in unfit]
    assert actions(mine) == {1: "forward", 2: "left", 4: "forward"}
    assert folded(mine).named_situations(BASIC)["door"][0] == 1.0


def test_merge_rewards_add_up_with_credits_that_fit(mine: Path, theirs: Path) -> None:
    append(mine, rewarded(1, 1, "mine"), replaced(3, "left", "forward"), at(4, -FAR, command_id="mine-4"))
    with Journal.open(mine, BINDING) as journal:
        numbers = {FIRST_VALUE: 0.5, VALUES_INCLUDE: 6.0}
        journal.checkpoint(Statistics(values={1: 0.5, 2: 0.5}, numbers=numbers))
    changes = {1: -0.5, 4: -0.25, 3: -0.125, 9: -1.0}
    blame = RlaRewarded(1, -1, 390, origin("theirs"), tuple(Credit(*each) for each in changes.items()))
    append(theirs, at(4, FAR, command_id="theirs-4"), blame)
    merged = merge(mine, theirs)
    assert folded(mine).appraisal(1) == (1, 1)
    *_, last = brought(mine, merged)
    assert isinstance(last.event, RlaRewarded)
    assert last.event.credits == (Credit(1, -0.5), Credit(5, -0.25))
    with Journal.read_only(mine) as journal:
        assert journal.statistics().values == {1: 0.0, 2: 0.5, 5: 0.25}


def test_merge_of_a_merged_file_keeps_free_first_ids(mine: Path, theirs: Path, tmp_path: Path) -> None:
    append(mine, at(4, FAR, "left", "same"), at(5, 3 * FAR, "left", "other"))
    append(theirs, at(4, -FAR, "right", "same"))
    before = merge(theirs, mine)
    third = begun(tmp_path / "third")
    merged = merge(third, theirs)
    found = [record.event.origin.command_id for record in brought(third, merged)]
    assert found == [
        f"{merged.merge_id}/same", f"{merged.merge_id}/{before.merge_id}/same", f"{merged.merge_id}/other"
    ]  # fmt: skip
    assert merge(third, mine).lessons == 0


def test_merge_is_undone_and_redone_together(mine: Path, theirs: Path) -> None:
    append(theirs, at(4, FAR, "left", "theirs-4"), replaced(4, "back", "left"), replaced(2, "left", "forward"))
    before = folded(mine).rlas
    merged = merge(mine, theirs)
    after = folded(mine).rlas
    planned = plan_undo(mine, merged.merge_id, teacher="command line")
    assert len(planned.lessons) == 3
    apply_plan(planned, STAMP)
    assert folded(mine).rlas == before
    with refused(KnowledgeCode.LESSON_REFUSED, mine, outcome=RefusalCode.UNDONE_ALREADY):
        plan_undo(mine, merged.merge_id, teacher="command line")
    assert (merge(mine, theirs).lessons, merge(mine, theirs).stay_undone) == (0, 3)
    apply_plan(plan_redo(mine, merged.merge_id, teacher="command line"), STAMP)
    assert folded(mine).rlas == after
    with refused(KnowledgeCode.LESSON_REFUSED, mine, outcome=RefusalCode.STANDS_ALREADY):
        plan_redo(mine, merged.merge_id, teacher="command line")


def test_merge_with_a_later_lesson_on_it_is_not_undone(mine: Path, theirs: Path) -> None:
    append(theirs, at(4, FAR, "left", "theirs-4"), at(5, -FAR, "left", "theirs-5"))
    merged = merge(mine, theirs)
    append(mine, replaced(4, "back", "left"))
    with refused(KnowledgeCode.LESSON_REFUSED, outcome=RefusalCode.TAUGHT_AFTER):
        plan_undo(mine, merged.merge_id, teacher="command line")


def test_merge_whose_places_are_taken_is_not_redone(mine: Path, theirs: Path) -> None:
    append(theirs, replaced(1, "left", "forward"))
    merged = merge(mine, theirs)
    apply_plan(plan_undo(mine, merged.merge_id, teacher="command line"), STAMP)
    append(mine, replaced(1, "right", "forward"))
    with refused(KnowledgeCode.LESSON_REFUSED, mine, outcome=RefusalCode.TAUGHT_INSTEAD):
        plan_redo(mine, merged.merge_id, teacher="command line")


def test_merge_refused_or_dry_run_changes_nothing(mine: Path, theirs: Path, tmp_path: Path) -> None:
    append(theirs, at(4, FAR))
    whole = mine.read_bytes()
    with Journal.open(mine, BINDING):
        with refused(KnowledgeCode.ANOTHER_WRITER):
            merge(mine, theirs)
        assert merge(mine, theirs, dry_run=True).lessons == 1
    Journal.open(tmp_path / "other", replace(BINDING, feature_hash="another")).close()
    with refused(KnowledgeCode.OTHER_FEATURES):
        merge(mine, tmp_path / "other")
    assert mine.read_bytes() == whole


def test_merge_full_disk_writes_all_or_nothing(mine: Path, theirs: Path) -> None:
    append(theirs, *(at(number, FAR * number, command_id=f"theirs-{number}") for number in range(4, 40)))
    before = len(events(mine))
    failed = 0
    for room in range(0, 80_000, 4_000):
        with largest_file(room):
            try:
                merge(mine, theirs)
            except KnowledgeError:
                failed += 1
        assert len(events(mine)) in (before, before + 36)
    assert failed
    merge(mine, theirs)
    assert len(events(mine)) == before + 36


Step = tuple[int, int]
steps = st.lists(st.tuples(st.integers(0, 6), st.integers(0, 20)), max_size=12)


def teach(path: Path, whose: str, steps: Iterable[Step]) -> None:
    system = folded(path)
    taught = list[TeachingEvent]()
    for number, (what, which) in enumerate(steps):
        name = f"{whose}-{len(system.history.records)}-{number}"
        living = [rla.rla_id for rla in system.rlas]
        lessons = [record.event.origin.command_id for record in system.history.records]
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
            case 5:
                event = named(which, name)
            case _:
                event = LessonRedone(lesson, origin(name))
        try:
            system.apply(event)
        except InvalidEventError:
            continue
        taught.append(event)
    append(path, *taught)


@settings(examples(24), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(steps, steps, steps, st.sampled_from(["ann", "bob"]))
def test_merge_random_files_fit_once_and_then_change_nothing(
    tmp_path_factory: pytest.TempPathFactory, first: list[Step], here: list[Step], there: list[Step], whose: str
) -> None:
    folder = tmp_path_factory.mktemp("merge")
    mine, theirs = begun(folder / "mine"), folder / "theirs"
    teach(mine, "both", first)
    shutil.copy(mine, theirs)
    teach(mine, "ann", here)
    teach(theirs, whose, there)
    unchanged = events(theirs)
    before = folded(mine)
    merged = merge(mine, theirs)
    after, other = folded(mine), folded(theirs)
    keys, keys_there = lesson_keys(after), lesson_keys(other)
    standing = {
        command_id for command_id in keys_there if (found := other.history.get(command_id)) and not found.undone
    }
    assert {keys_there[each] for each in standing - set(left_out(merged))} <= set(keys.values())
    assert after.history.records[: len(before.history.records)] == before.history.records
    once = events(mine)
    assert merge(mine, theirs).lessons == 0
    assert events(mine) == once
    assert events(theirs) == unchanged
