"""Brings the lessons of another knowledge file in: what changed there since both were one, pile by pile.

A pile are the lessons about one RLA, or that gave one name; those that stand lie on one another. A pile that changed
only there becomes as it is there, by undos, redos and new lessons. One that changed on both sides is a conflict, and
so is a new RLA that says something else than one of this file at nearly the same place.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from kurt2rt.expectations.expectation import Expectation
from kurt2rt.knowledge.binding import require_same
from kurt2rt.knowledge.changing import new_origin, write
from kurt2rt.knowledge.difference import living
from kurt2rt.knowledge.entry import JournalEntry
from kurt2rt.knowledge.error import KnowledgeError
from kurt2rt.knowledge.journal import Journal
from kurt2rt.knowledge.kinship import Taught, kinship_of, known_rows, read_taught, standing_piles
from kurt2rt.knowledge.nearness import Borders, Contradictions
from kurt2rt.knowledge.statistics import Statistics
from kurt2rt.rla.lesson_book import LessonRecord, Pile, pile_of
from kurt2rt.rla.rla import (
    Appraised,
    KnowledgeMerged,
    LessonRedone,
    LessonUndone,
    Rla,
    RlaCreated,
    RlaDeleted,
    RlaRewarded,
    SessionBegun,
    SessionEnded,
    TeachingEvent,
    rla_title,
)
from kurt2rt.rla.rla_system import RlaSystem, UnfitEventError

Side = Literal["mine", "theirs"]


@dataclass(frozen=True, slots=True)
class Conflict:
    """What cannot be both."""

    mine: str
    """What this file says, in words."""
    theirs: str
    where: str
    """Why they exclude each other."""


@dataclass(frozen=True)
class Merge:
    """What a merge would write."""

    entries: tuple[JournalEntry, ...]
    statistics: Statistics
    conflicts: tuple[Conflict, ...]
    """All that were found; settled where a side was preferred."""
    lessons: int
    """How many lessons are new here."""
    undone: int
    redone: int
    new_ids: dict[int, int]
    """RLA id there -> the new id here, of the RLAs that come with it."""


@dataclass(frozen=True, slots=True)
class _Pile:
    """Lessons about one thing, by their command ids here: as they were, as they are there, as they are here."""

    pile: Pile
    """There."""
    before: tuple[str, ...]
    theirs: tuple[str, ...]
    mine: tuple[str, ...]


class Merging:
    """One merge, planned; changes neither file."""

    def __init__(self, mine: Taught, theirs: Taught, borders: Borders, *, teacher: str, stamp: str) -> None:
        """`teacher` and `stamp` of what is undone or redone by it; lessons keep those that they have."""
        self._mine, self._theirs = mine, theirs
        self._borders = borders
        self._teacher, self._stamp = teacher, stamp
        self._kinship = kinship_of(mine, theirs)
        self._known = known_rows(mine.entries, theirs.entries)
        self._record = theirs.records
        self._by_name = {self._kinship.name_for(record.event): record.event for record in theirs.system.lessons}
        """Lessons of theirs by the command id that they have, or would have, here."""
        self._stamps = {entry.event.origin.command_id: entry.stamped_at for entry in theirs.entries}
        self._mine_record = mine.records

    def plan(self, saved: Statistics, of_theirs: Statistics, prefer: Side | None) -> Merge:
        """What to write, given the statistics of both files. Raises KnowledgeError where it does not fit together."""
        moved, both = self._changed_piles()
        conflicts = [self._conflict_of(each) for each in both]
        if prefer == "theirs":
            moved += both
        contradictions = Contradictions(self._unknown_there(moved), self._borders)
        left_out, deletions = set[Pile](), list[int]()
        for each in moved:
            rla = self._created(each)
            near = None if rla is None else contradictions.of(rla)
            if rla is not None and near is not None:
                distance = f"{near.distance:.1f} apart, within {100 * self._borders.shares[rla.level]:.0f} % of R"
                conflicts.append(Conflict(_says(near.rla), _says(rla), distance))
                if prefer == "theirs":
                    deletions.append(near.rla.rla_id)
                else:
                    left_out.add(each.pile)
        first_new = self._mine.system.next_id
        events = self._events([each for each in moved if each.pile not in left_out], deletions)
        entries = [*events, *self._other_events()]
        self._require_fit(entries)
        count = {kind: sum(isinstance(each.event, kind) for each in events) for kind in (LessonUndone, LessonRedone)}
        lessons = len(events) - sum(count.values()) - len(set(deletions))
        if entries or conflicts:
            last = self._theirs.entries[-1].event.origin.command_id
            name = self._theirs.journal.path.name
            merged = KnowledgeMerged(name, len(self._theirs.entries), last, new_origin("merge", self._teacher))
            entries.append(JournalEntry(merged, self._stamp))
        new_ids = {there: here for there, here in self._kinship.rlas.items() if here >= first_new}
        statistics = self._statistics(saved, of_theirs, new_ids)
        return Merge(
            entries=tuple(entries),
            statistics=statistics,
            conflicts=tuple(conflicts),
            lessons=lessons,
            undone=count[LessonUndone],
            redone=count[LessonRedone],
            new_ids=new_ids,
        )

    def _changed_piles(self) -> tuple[list[_Pile], list[_Pile]]:
        """Piles that are to become as they are there, and those that changed on both sides."""
        theirs, mine = self._theirs, self._mine
        before = standing_piles(_as_of(theirs, self._known))
        now = standing_piles(theirs.system.lessons)
        here = standing_piles(mine.system.lessons)
        moved, both = list[_Pile](), list[_Pile]()
        for pile in {pile_of(record.event): None for record in theirs.system.lessons}:
            of_mine = self._kinship.pile(pile)
            each = _Pile(
                pile,
                self._names(before.get(pile, ())),
                self._names(now.get(pile, ())),
                () if of_mine is None else here.get(of_mine, ()),
            )
            if each.theirs == each.before or each.theirs == each.mine:
                continue
            if each.mine == each.before:
                moved.append(each)
                continue
            added = self._rewards_added(each)
            if added is not None:
                moved.extend([replace(each, theirs=(*each.mine, *added))] if added else [])
            elif not self._come_to_the_same(pile, of_mine):
                both.append(each)
        return moved, both

    def _unknown_there(self, moved: Sequence[_Pile]) -> list[Rla]:
        """RLAs of mine that theirs was taught without, or against, and that stay."""
        known = {self._kinship.pile(each.pile) for each in moved}
        actions = {self._kinship.rlas.get(rla.rla_id): rla.action for rla in living(self._theirs)}
        return [rla for rla in living(self._mine) if rla.rla_id not in known and actions.get(rla.rla_id) != rla.action]

    def _names(self, lessons: Sequence[str]) -> tuple[str, ...]:
        return tuple(self._kinship.name_for(self._record[lesson].event) for lesson in lessons)

    def _rewards_added(self, pile: _Pile) -> tuple[str, ...] | None:
        """What theirs adds to mine where one of them only praised and blamed; None where they exclude each other."""
        size = len(pile.before)
        if pile.mine[:size] != pile.before or pile.theirs[:size] != pile.before:
            return None
        ours = [self._mine_record[name].event for name in pile.mine[size:]]
        added = tuple(name for name in pile.theirs[size:] if name not in pile.mine)
        of_theirs = [self._by_name[name] for name in added]
        if all(isinstance(event, RlaRewarded) for event in of_theirs):
            return () if any(isinstance(event, RlaDeleted) for event in ours) else added
        return added if all(isinstance(event, RlaRewarded) for event in ours) else None

    def _come_to_the_same(self, pile: Pile, of_mine: Pile | None) -> bool:
        if isinstance(pile, tuple):
            level, name = pile
            return self._theirs.system.named_at(level).get(name) == self._mine.system.named_at(level).get(name)
        theirs, mine = self._theirs.system.get(pile), None
        if isinstance(of_mine, int):
            mine = self._mine.system.get(of_mine)
        return (theirs and theirs.action) == (mine and mine.action)

    def _conflict_of(self, each: _Pile) -> Conflict:
        of_mine = self._kinship.pile(each.pile)
        if isinstance(each.pile, tuple):
            level, name = each.pile
            title = f"the name {name}"
            there, here = (
                f"{title} is given" if name in side.system.named_at(level) else f"{title} is not given"
                for side in (self._theirs, self._mine)
            )
            return Conflict(here, there, "each means another situation, or one means none")
        there = _state(self._theirs.system.get(each.pile), each.pile)
        rla = self._mine.system.get(of_mine) if isinstance(of_mine, int) else None
        here = _state(rla, of_mine) if isinstance(of_mine, int) else "it was left out here before"
        return Conflict(here, there, "changed on both sides")

    def _created(self, each: _Pile) -> Rla | None:
        """The RLA that a pile brings anew, as it lives there."""
        if isinstance(each.pile, tuple) or each.pile in self._kinship.rlas:
            return None
        rla = self._theirs.system.get(each.pile)
        return None if rla is None or rla.asks else rla

    def _events(self, moved: Sequence[_Pile], deletions: Sequence[int]) -> list[JournalEntry]:
        """Undos, the newest lesson first, then lessons in the order in which they were taught there."""
        place = {name: number for number, name in enumerate(self._mine_record)}
        undos, adds = list[str](), set[str]()
        for each in moved:
            same = _common(each.mine, each.theirs)
            undos += each.mine[same:]
            adds |= set(each.theirs[same:])
        events: list[TeachingEvent] = [
            LessonUndone(name, new_origin("undo", self._teacher))
            for name in sorted(undos, key=lambda name: -place[name])
        ]
        events += [RlaDeleted(rla_id, new_origin("delete", self._teacher)) for rla_id in dict.fromkeys(deletions)]
        entries = [JournalEntry(event, self._stamp) for event in events]
        next_id = self._mine.system.next_id  # nothing is applied yet
        for record in self._theirs.system.lessons:
            lesson = record.event
            own = lesson.origin.command_id
            name = self._kinship.name_for(lesson)
            if name not in adds:
                continue
            if own in self._kinship.lessons:
                entries.append(JournalEntry(LessonRedone(name, new_origin("redo", self._teacher)), self._stamp))
                continue
            new_id = None
            if isinstance(lesson, RlaCreated):
                new_id = self._kinship.rlas[lesson.rla.rla_id] = next_id
                next_id += 1
            entries.append(JournalEntry(self._kinship.here(lesson, name, new_id), self._stamps[own]))
        return entries

    def _other_events(self) -> list[JournalEntry]:
        """Sessions and agreements that are not here."""
        return [
            JournalEntry(entry.event, entry.stamped_at)
            for entry in self._theirs.entries[self._known :]
            if isinstance(entry.event, SessionBegun | SessionEnded | Appraised)
            and entry.event.origin.command_id not in self._kinship.taken
        ]

    def _require_fit(self, entries: Sequence[JournalEntry]) -> None:
        for entry in entries:
            try:
                self._mine.system.apply(entry.event)
            except UnfitEventError as error:
                raise KnowledgeError(
                    f"{self._theirs.journal.path}: cannot be brought into {self._mine.journal.path.name}: {error}; "
                    "undo there what is in the way, or go on in one of them"
                ) from error

    def _statistics(self, saved: Statistics, of_theirs: Statistics, new_ids: dict[int, int]) -> Statistics:
        """What was counted of the RLAs that are new here comes with them; what they are worth, by their lessons."""
        both = {**self._kinship.rlas}
        uses = {new: of_theirs.uses[old] for old, new in new_ids.items() if old in of_theirs.uses}
        transitions = {
            (both[before], both[after]): count
            for (before, after), count in of_theirs.transitions.items()
            if before in both and after in both and (before in new_ids or after in new_ids)
        }
        expectations = {
            new: self._renamed(of_theirs.expectations[old])
            for old, new in new_ids.items()
            if old in of_theirs.expectations
        }
        return replace(
            saved,
            uses={**saved.uses, **uses},
            transitions={**saved.transitions, **transitions},
            expectations={**saved.expectations, **expectations},
        )

    def _renamed(self, expectation: Expectation) -> Expectation:
        record = self._record.get(expectation.lesson)
        return expectation if record is None else replace(expectation, lesson=self._kinship.name_for(record.event))


def merge(
    path: Path, other: Path, borders: Borders, prefer: Side | None, *, teacher: str, stamp: str, dry_run: bool = False
) -> Merge:
    """Bring what was taught in `other` since both were one into `path`; durable on return, all or nothing.

    Where there are conflicts and no side is preferred, or `dry_run`, nothing is changed. Raises KnowledgeError, also
    for knowledge of other features or another task, and while a robot runs on `path`.
    """
    with Journal.read_only(path) as look:
        binding = look.binding
    with Journal.read_only(other) as look:
        require_same(look.binding, binding, other, look.has_lessons_at)
        theirs, of_theirs = read_taught(look), look.statistics()
    both = replace(binding, levels={**theirs.journal.binding.levels, **binding.levels})
    with Journal.open(path, both) as journal:
        mine, saved = read_taught(journal), journal.statistics()
        planned = Merging(mine, theirs, borders, teacher=teacher, stamp=stamp).plan(saved, of_theirs, prefer)
        if planned.entries and not dry_run and (prefer is not None or not planned.conflicts):
            write(journal, planned.entries, planned.statistics)
    return planned


def _as_of(taught: Taught, rows: int) -> tuple[LessonRecord, ...]:
    system = RlaSystem(taught.system.dimensions, math.inf)
    system.apply_all(entry.event for entry in taught.entries[:rows])
    return system.lessons


def _common(one: Sequence[str], other: Sequence[str]) -> int:
    same = 0
    for mine, theirs in zip(one, other, strict=False):
        if mine != theirs:
            break
        same += 1
    return same


def _says(rla: Rla) -> str:
    return f"{rla.title} says {rla.action}"


def _state(rla: Rla | None, rla_id: int) -> str:
    if rla is None:
        return f"{rla_title(rla_id, '')} is gone"
    return f"{rla.title} asks" if rla.asks else _says(rla)
