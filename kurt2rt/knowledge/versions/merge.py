"""Merge of another knowledge file: its changes since the merge base, stack by stack.

A stack is the lessons about one RLA, or those that gave one name; lessons that stand lie on one another. A stack that
changed only there becomes as it is there, by undos, redos and new lessons. A stack that changed in both files is a
conflict. So is a new RLA with another action than an RLA of this file at nearly the same condition. Rewards of both
files add up one by one, because their order does not matter.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path

from kurt2rt.core.rla.events import KnowledgeMerged
from kurt2rt.core.rla.expectation import Expectation
from kurt2rt.core.rla.rla import Rla
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.journal.binding import require_compatible
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.knowledge.versions.contradictions import Contradictions, Radii
from kurt2rt.knowledge.versions.diff import active_rlas
from kurt2rt.knowledge.versions.editing import append_with_values, new_origin
from kurt2rt.knowledge.versions.lesson_identity import (
    KnowledgeContent,
    LessonKey,
    StackKey,
    read_content,
    standing_stacks,
)
from kurt2rt.knowledge.versions.merge_base import Resolution, Side, StackPair, ThreeWayDiff
from kurt2rt.knowledge.versions.merge_writer import LeftOutCode, LeftOutReward, MergeWriter, TargetStack

__all__ = ["Conflict", "ConflictCode", "MergePlan", "Merger", "NameState", "RlaState", "Side", "merge"]


class ConflictCode(StrEnum):
    """Reason why two states exclude each other."""

    CHANGED_ON_BOTH_SIDES = "changed on both sides"
    REWARDED_HERE = "rewarded here"
    """Rewarded in this file for a lesson that was undone in the other one."""
    OTHER_SITUATION = "other situation"
    """A name means different situations, or none in one file."""
    NEAR = "near"
    """Different actions at nearly the same condition."""


@dataclass(frozen=True, slots=True)
class RlaState:
    """State of an RLA in one file."""

    rla_id: int | None
    """Id in that file; None if the file left the RLA out in an earlier merge."""
    rla: Rla | None
    """None if it does not live."""


@dataclass(frozen=True, slots=True)
class NameState:
    """State of a situation's name in one file."""

    name: str
    given: bool


@dataclass(frozen=True, slots=True)
class Conflict:
    """Two states that exclude each other."""

    mine: RlaState | NameState
    theirs: RlaState | NameState
    code: ConflictCode
    distance: float | None = None
    """Distance of the RLAs' conditions, for NEAR."""
    radius_fraction: float | None = None
    """Fraction of R within which a correction replaces, for NEAR."""


@dataclass(frozen=True)
class MergePlan:
    """Rows and statistics that a merge would write."""

    entries: tuple[JournalEntry, ...]
    statistics: Statistics
    conflicts: tuple[Conflict, ...]
    """All that were found; settled if a side was preferred."""
    lessons: int
    """Number of lessons that are new here."""
    undone: int
    redone: int
    new_ids: dict[int, int]
    """RLA id there -> the new id here, of the RLAs that are created."""
    left_out: tuple[LeftOutReward, ...]


@dataclass(frozen=True, slots=True)
class _StackChange:
    """A stack that differs, the resolution for its lessons, and its rewards to add and to remove."""

    key: StackKey
    sides: StackPair
    resolution: Resolution
    new_rewards: tuple[LessonKey, ...]
    withdrawn_rewards: tuple[LessonKey, ...]

    @property
    def orphaned(self) -> frozenset[LessonKey]:
        """Return the local rewards whose lesson was removed in the other file."""
        theirs, lessons = set(self.sides.theirs), self._rewarded_lessons()
        return frozenset(key for key in self._own_rewards() if lessons[key] not in theirs)

    @property
    def buried(self) -> frozenset[LessonKey]:
        """Return the rewards withdrawn there on which a lesson of this file lies."""
        mine = self.sides.mine
        tops = [place for place, key in enumerate(mine) if not key.is_reward]
        return frozenset(key for key in self.withdrawn_rewards if tops and mine.index(key) < tops[-1])

    def take_theirs(self) -> TargetStack:
        """Return the lessons of theirs, each with the rewards that mine gave for it."""
        lessons, own = self._rewarded_lessons(), self._own_rewards()
        then = list[LessonKey]()
        for key in self.sides.theirs:
            if not key.is_reward:
                then += [key, *(reward for reward in own if lessons[reward] == key)]
            elif key in self.new_rewards or key in self.sides.mine:
                then.append(key)
        return TargetStack(self.key, self.sides.mine, tuple(then))

    def keep_mine(self) -> TargetStack:
        """Return the lessons of mine; withdrawn rewards beneath one of them stay."""
        then = tuple(key for key in self.sides.mine if key not in self.withdrawn_rewards or key in self.buried)
        return TargetStack(self.key, self.sides.mine, (*then, *self.new_rewards))

    def _own_rewards(self) -> list[LessonKey]:
        """Return the rewards of mine that are not in theirs and stay."""
        theirs = set(self.sides.theirs)
        return [
            key for key in self.sides.mine if key.is_reward and key not in theirs and key not in self.withdrawn_rewards
        ]

    def _rewarded_lessons(self) -> dict[LessonKey, LessonKey | None]:
        """Return the lesson that each reward of mine was given for."""
        lessons, lesson = dict[LessonKey, LessonKey | None](), None
        for key in self.sides.mine:
            if key.is_reward:
                lessons[key] = lesson
            else:
                lesson = key
        return lessons


class Merger:
    """Planner of one merge. It changes neither file, but the fold of mine, and so plans once."""

    def __init__(
        self, mine: KnowledgeContent, theirs: KnowledgeContent, radii: Radii, *, teacher: str, stamp: str
    ) -> None:
        """Prepare; `teacher` and `stamp` are those of undos and redos, lessons keep their own."""
        self._mine, self._theirs = mine, theirs
        self._radii = radii
        self._teacher, self._stamp = teacher, stamp
        self._writer = MergeWriter(mine, theirs, teacher=teacher, stamp=stamp)

    def plan(self, saved: Statistics, of_theirs: Statistics, prefer: Side | None) -> MergePlan:
        """Return the plan.

        Args:
            saved: statistics of mine.
            of_theirs: statistics of theirs.
            prefer: the side that settles conflicts; None: they are only reported.

        Raises:
            KnowledgeError: a lesson of theirs does not fit.
        """
        writer, changes = self._writer, self._changed_stacks()
        both = [each for each in changes if each.resolution is Resolution.CONFLICT]
        conflicts = [self._conflict_of(each) for each in both]
        moved = [
            each
            for each in changes
            if each.resolution is Resolution.TAKE_THEIRS or (each in both and prefer == "theirs")
        ]
        near, left_out, deletions = self._find_contradictions(moved, prefer)
        conflicts += near
        taken = {each.key for each in moved}
        buried = [self._buried(key) for each in changes if each.key not in taken for key in each.buried]
        known = frozenset(self._mine.lesson_keys.values())
        wanted = [
            each.take_theirs() if each.key in taken else each.keep_mine()
            for each in changes
            if each.key not in left_out
        ]
        writer.write(wanted, deletions)
        stands = {key for each in wanted for key in each.then if writer.name_of(key) is not None}
        stood = {key for each in wanted for key in each.now}
        writer.write_sessions()
        entries, rewards = list(writer.entries), (*buried, *writer.left_out)
        if entries or conflicts or rewards:
            entries.append(JournalEntry(self._merge_event(), self._stamp))
        return MergePlan(
            entries=tuple(entries),
            statistics=self._statistics(saved, of_theirs),
            conflicts=tuple(conflicts),
            lessons=len(stands - known),
            undone=len(stood - stands),
            redone=len((stands & known) - stood),
            new_ids=dict(writer.new_ids),
            left_out=rewards,
        )

    def _merge_event(self) -> KnowledgeMerged:
        last = self._theirs.entries[-1].event.origin.command_id
        name = self._theirs.journal.path.name
        return KnowledgeMerged(name, len(self._theirs.entries), last, new_origin("merge", self._teacher))

    def _changed_stacks(self) -> list[_StackChange]:
        """Return the stacks of theirs that are not the same here."""
        here = standing_stacks(self._mine.system.lessons, self._mine.lesson_keys)
        there = standing_stacks(self._theirs.system.lessons, self._theirs.lesson_keys)
        diff, found = ThreeWayDiff(self._mine, self._theirs), list[_StackChange]()
        for key in self._theirs.stacks:
            sides = StackPair(here.get(key, ()), there.get(key, ()))
            if sides.mine == sides.theirs:
                continue
            resolution = diff.resolution_of(key, sides)
            if resolution is Resolution.CONFLICT and self._has_equal_result(key):
                resolution = Resolution.KEEP_MINE
            change = _StackChange(key, sides, resolution, diff.new_rewards(sides), diff.withdrawn_rewards(sides))
            if resolution is Resolution.TAKE_THEIRS and change.orphaned:
                change = replace(change, resolution=Resolution.CONFLICT)
            found.append(change)
        return found

    def _find_contradictions(
        self, moved: Sequence[_StackChange], prefer: Side | None
    ) -> tuple[list[Conflict], set[StackKey], list[int]]:
        """Return conflicts of new RLAs with those of mine, the stacks to leave out, and the RLA ids to delete."""
        contradictions = Contradictions(self._unknown_there(moved), self._radii)
        conflicts, left_out, deletions = list[Conflict](), set[StackKey](), list[int]()
        for each in moved:
            rla = self._created(each)
            near = None if rla is None else contradictions.find(rla)
            if rla is not None and near is not None:
                mine, theirs = RlaState(near.rla.rla_id, near.rla), RlaState(rla.rla_id, rla)
                fraction = self._radii.fractions[rla.level]
                conflicts.append(Conflict(mine, theirs, ConflictCode.NEAR, near.distance, fraction))
                if prefer == "theirs":
                    deletions.append(near.rla.rla_id)
                else:
                    left_out.add(each.key)
        return conflicts, left_out, deletions

    def _unknown_there(self, moved: Sequence[_StackChange]) -> list[Rla]:
        """Return the RLAs of mine that stay, and that theirs does not have or has with another action."""
        stacks, keys = {each.key for each in moved}, self._mine.rla_keys
        actions = {self._theirs.rla_keys[rla.rla_id]: rla.action for rla in active_rlas(self._theirs)}
        return [
            rla
            for rla in active_rlas(self._mine)
            if keys[rla.rla_id] not in stacks and actions.get(keys[rla.rla_id]) != rla.action
        ]

    def _has_equal_result(self, key: StackKey) -> bool:
        stack = self._theirs.stacks[key]
        if isinstance(stack, tuple):
            level, name = stack
            return self._theirs.system.named_situations(level).get(name) == self._mine.system.named_situations(
                level
            ).get(name)
        theirs, mine = self._theirs.system.get(stack), self._rla_here(key)
        return (theirs and theirs.action) == (mine and mine.action)

    def _rla_here(self, key: StackKey) -> Rla | None:
        stack = self._mine.stacks.get(key)
        return self._mine.system.get(stack) if isinstance(stack, int) else None

    def _conflict_of(self, change: _StackChange) -> Conflict:
        stack, of_mine = self._theirs.stacks[change.key], self._mine.stacks.get(change.key)
        if isinstance(stack, tuple):
            level, name = stack
            theirs, mine = (
                NameState(name, given=name in side.system.named_situations(level))
                for side in (self._theirs, self._mine)
            )
            return Conflict(mine, theirs, ConflictCode.OTHER_SITUATION)
        there = RlaState(stack, self._theirs.system.get(stack))
        if not isinstance(of_mine, int):
            return Conflict(RlaState(None, None), there, ConflictCode.CHANGED_ON_BOTH_SIDES)
        code = ConflictCode.REWARDED_HERE if change.orphaned else ConflictCode.CHANGED_ON_BOTH_SIDES
        return Conflict(RlaState(of_mine, self._rla_here(change.key)), there, code)

    def _created(self, change: _StackChange) -> Rla | None:
        """Return the new RLA that a stack brings, as it lives there; None if there is none with an action."""
        stack = self._theirs.stacks[change.key]
        if isinstance(stack, tuple) or change.key in self._mine.stacks:
            return None
        rla = self._theirs.system.get(stack)
        return None if rla is None or rla.is_withdrawn else rla

    def _buried(self, key: LessonKey) -> LeftOutReward:
        names = [name for name, other in self._mine.lesson_keys.items() if other == key]
        return LeftOutReward(LeftOutCode.BURIED, self._mine.records[names[-1]])

    def _statistics(self, saved: Statistics, of_theirs: Statistics) -> Statistics:
        """Return the statistics of mine with the counts of the RLAs that are new here; values follow from lessons."""
        both, new_ids = self._writer.rlas, self._writer.new_ids
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
        key = self._theirs.lesson_keys.get(expectation.lesson)
        name = None if key is None else self._writer.name_of(key)
        return expectation if name is None else replace(expectation, lesson=name)


def merge(
    path: Path, other: Path, radii: Radii, prefer: Side | None, *, teacher: str, stamp: str, dry_run: bool = False
) -> MergePlan:
    """Merge the lessons of `other` since the merge base into `path`; durable on return, all or nothing.

    With conflicts and no preferred side, or with `dry_run`, nothing is changed, and a robot may run on `path`.

    Args:
        path: of the file that is changed.
        other: of the file that is read.
        radii: of the task.
        prefer: the side that settles conflicts; None: neither.
        teacher: of undos and redos.
        stamp: of undos and redos, UTC, ISO 8601.
        dry_run: only plan.

    Raises:
        KnowledgeError: a file cannot be used, features or task differ, or `path` was changed during the planning.
    """
    with Journal.read_only(path) as journal:
        mine, saved = read_content(journal), journal.statistics()
    binding = mine.journal.binding
    with Journal.read_only(other) as journal:
        require_compatible(journal.binding, binding, other, journal.has_lessons_at)
        theirs, of_theirs = read_content(journal), journal.statistics()
    planned = Merger(mine, theirs, radii, teacher=teacher, stamp=stamp).plan(saved, of_theirs, prefer)
    if not planned.entries or dry_run or (prefer is None and planned.conflicts):
        return planned
    both = replace(binding, levels={**theirs.journal.binding.levels, **binding.levels})
    with Journal.open(path, both) as journal:
        if tuple(journal.entries()) != mine.entries or journal.statistics() != saved:
            raise KnowledgeError(KnowledgeCode.CHANGED_MEANWHILE, where=path)
        append_with_values(journal, planned.entries, planned.statistics)
    return planned
