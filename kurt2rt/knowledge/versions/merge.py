"""Brings the lessons of another knowledge file in: what changed there since both last met, pile by pile.

A pile are the lessons about one RLA, or that gave one name; those that stand lie on one another. A pile that changed
only there becomes as it is there, by undos, redos and new lessons. One that changed on both sides is a conflict, and
so is a new RLA that says something else than one of this file at nearly the same place. Praise and blame of both add
up, each by itself: their order does not matter.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path

from kurt2rt.core.rla.expectation import Expectation
from kurt2rt.core.rla.rla import KnowledgeMerged, Rla, rla_title
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.journal.binding import require_compatible
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.knowledge.versions.contradictions import Contradictions, Radii
from kurt2rt.knowledge.versions.diff import living
from kurt2rt.knowledge.versions.editing import new_origin, write
from kurt2rt.knowledge.versions.lesson_identity import (
    KnowledgeContent,
    LessonKey,
    StackKey,
    read_content,
    standing_stacks,
)
from kurt2rt.knowledge.versions.merge_base import Resolution, Side, StackPair, ThreeWayDiff
from kurt2rt.knowledge.versions.merge_writer import MergeWriter, TargetStack

__all__ = ["Conflict", "ConflictCode", "MergePlan", "Merger", "Side", "merge"]


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
class Conflict:
    """Two states that exclude each other."""

    mine: str
    """What this file says, in words."""
    theirs: str
    code: ConflictCode
    distance: float | None = None
    """Between the conditions of the RLAs, for NEAR."""
    radius_fraction: float | None = None
    """Fraction of R within which a correction replaces, for NEAR."""


@dataclass(frozen=True)
class MergePlan:
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
    left_out: tuple[str, ...]
    """Praise and blame that is not brought, or not taken back, and why, in words."""


@dataclass(frozen=True, slots=True)
class _StackChange:
    """A pile, what becomes of its lessons here, and of its rewards."""

    key: StackKey
    sides: StackPair
    resolution: Resolution
    came: tuple[LessonKey, ...]
    """Praise and blame that comes."""
    went: tuple[LessonKey, ...]
    """Praise and blame that goes."""

    @property
    def orphaned(self) -> frozenset[LessonKey]:
        """Praise and blame of this file that stands on something that is not there any more."""
        theirs, at = set(self.sides.theirs), self._under()
        own = (key for key in self.sides.mine if key.is_reward and key not in theirs and key not in self.went)
        return frozenset(key for key in own if at[key] not in theirs)

    def take_theirs(self) -> TargetStack:
        """The lessons of theirs, with the rewards of mine where they were given."""
        at, theirs = self._under(), set(self.sides.theirs)
        own = [key for key in self.sides.mine if key.is_reward and key not in theirs and key not in self.went]
        then = list[LessonKey]()
        for key in self.sides.theirs:
            if not key.is_reward:
                then += [key, *(reward for reward in own if at[reward] == key)]
            elif key in self.came or key in self.sides.mine:
                then.append(key)
        return TargetStack(self.key, self.sides.mine, tuple(then))

    def keep_mine(self) -> TargetStack:
        """The lessons of mine; a reward under one of them stays."""
        then = tuple(key for key in self.sides.mine if key not in self.went or key in self.buried)
        return TargetStack(self.key, self.sides.mine, (*then, *self.came))

    @property
    def buried(self) -> frozenset[LessonKey]:
        """Rewards that went there, and on which a lesson of this file lies."""
        mine = self.sides.mine
        tops = [place for place, key in enumerate(mine) if not key.is_reward]
        return frozenset(key for key in self.went if tops and mine.index(key) < tops[-1])

    def _under(self) -> dict[LessonKey, LessonKey | None]:
        """On which lesson each reward of mine was given."""
        at, lesson = dict[LessonKey, LessonKey | None](), None
        for key in self.sides.mine:
            if key.is_reward:
                at[key] = lesson
            else:
                lesson = key
        return at


class Merger:
    """One merge, planned; changes neither file. Goes on with the fold of mine: plans once."""

    def __init__(
        self, mine: KnowledgeContent, theirs: KnowledgeContent, borders: Radii, *, teacher: str, stamp: str
    ) -> None:
        """`teacher` and `stamp` of what is undone or redone by it; lessons keep those that they have."""
        self._mine, self._theirs = mine, theirs
        self._borders = borders
        self._teacher, self._stamp = teacher, stamp
        self._bringing = MergeWriter(mine, theirs, teacher=teacher, stamp=stamp)

    def plan(self, saved: Statistics, of_theirs: Statistics, prefer: Side | None) -> MergePlan:
        """What to write, given the statistics of both files. Raises KnowledgeError where it does not fit together."""
        bringing, stacks = self._bringing, self._stack_changes()
        both = [each for each in stacks if each.resolution == "both"]
        conflicts = [self._conflict_of(each) for each in both]
        moved = [
            each
            for each in stacks
            if each.resolution == "as there" or (each.resolution == "both" and prefer == "theirs")
        ]
        changed = {each.key for each in moved}
        contradictions = Contradictions(self._unknown_there(moved), self._borders)
        left_out, deletions = set[StackKey](), list[int]()
        for each in moved:
            rla = self._created(each)
            near = None if rla is None else contradictions.of(rla)
            if rla is not None and near is not None:
                fraction = self._borders.fractions[rla.level]
                conflicts.append(Conflict(_says(near.rla), _says(rla), ConflictCode.NEAR, near.distance, fraction))
                if prefer == "theirs":
                    deletions.append(near.rla.rla_id)
                else:
                    left_out.add(each.key)
        buried = [self._stays(key) for each in stacks if each.key not in changed for key in each.buried]
        known = frozenset(self._mine.lesson_keys.values())
        wanted = [
            each.take_theirs() if each.key in changed else each.keep_mine()
            for each in stacks
            if each.key not in left_out
        ]
        bringing.write(wanted, deletions)
        stands = {key for each in wanted for key in each.then if bringing.name_of(key) is not None}
        stood = {key for each in wanted for key in each.now}
        bringing.write_sessions()
        entries, told = list(bringing.entries), (*buried, *bringing.left_out)
        if entries or conflicts or told:
            last = self._theirs.entries[-1].event.origin.command_id
            name = self._theirs.journal.path.name
            merged = KnowledgeMerged(name, len(self._theirs.entries), last, new_origin("merge", self._teacher))
            entries.append(JournalEntry(merged, self._stamp))
        return MergePlan(
            entries=tuple(entries),
            statistics=self._statistics(saved, of_theirs),
            conflicts=tuple(conflicts),
            lessons=len(stands - known),
            undone=len(stood - stands),
            redone=len((stands & known) - stood),
            new_ids=dict(bringing.new_ids),
            left_out=told,
        )

    def _stack_changes(self) -> list[_StackChange]:
        """Piles of theirs that are not the same here, and what becomes of them."""
        here = standing_stacks(self._mine.system.lessons, self._mine.lesson_keys)
        there = standing_stacks(self._theirs.system.lessons, self._theirs.lesson_keys)
        parting, found = ThreeWayDiff(self._mine, self._theirs), list[_StackChange]()
        for key in self._theirs.stacks:
            sides = StackPair(here.get(key, ()), there.get(key, ()))
            if sides.mine == sides.theirs:
                continue
            resolution = parting.resolve(key, sides)
            if resolution == "both" and self._come_to_the_same(key):
                resolution = "stays"
            came, went = parting.new_rewards(sides), parting.withdrawn_rewards(sides)
            stack = _StackChange(key, sides, resolution, came, went)
            found.append(replace(stack, resolution="both") if resolution == "as there" and stack.orphaned else stack)
        return found

    def _unknown_there(self, moved: Sequence[_StackChange]) -> list[Rla]:
        """RLAs of mine that theirs was taught without, or against, and that stay."""
        stacks, lesson_keys = {each.key for each in moved}, self._mine.rla_keys
        actions = {self._theirs.rla_keys[rla.rla_id]: rla.action for rla in living(self._theirs)}
        return [
            rla
            for rla in living(self._mine)
            if lesson_keys[rla.rla_id] not in stacks and actions.get(lesson_keys[rla.rla_id]) != rla.action
        ]

    def _come_to_the_same(self, key: StackKey) -> bool:
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

    def _conflict_of(self, each: _StackChange) -> Conflict:
        stack, of_mine = self._theirs.stacks[each.key], self._mine.stacks.get(each.key)
        if isinstance(stack, tuple):
            level, name = stack
            title = f"the name {name}"
            there, here = (
                f"{title} is given" if name in side.system.named_situations(level) else f"{title} is not given"
                for side in (self._theirs, self._mine)
            )
            return Conflict(here, there, ConflictCode.OTHER_SITUATION)
        there = _state(self._theirs.system.get(stack), stack)
        if not isinstance(of_mine, int):
            return Conflict("it was left out here before", there, ConflictCode.CHANGED_ON_BOTH_SIDES)
        code = ConflictCode.REWARDED_HERE if each.orphaned else ConflictCode.CHANGED_ON_BOTH_SIDES
        return Conflict(_state(self._rla_here(each.key), of_mine), there, code)

    def _created(self, each: _StackChange) -> Rla | None:
        """The RLA that a pile brings anew, as it lives there."""
        stack = self._theirs.stacks[each.key]
        if isinstance(stack, tuple) or each.key in self._mine.stacks:
            return None
        rla = self._theirs.system.get(stack)
        return None if rla is None or rla.is_withdrawn else rla

    def _stays(self, key: LessonKey) -> str:
        names = [name for name, other in self._mine.lesson_keys.items() if other == key]
        record = self._mine.records[names[-1]]
        return (
            f"{record.text} by {record.event.origin.teacher} was taken back there, and stays under what came here since"
        )

    def _statistics(self, saved: Statistics, of_theirs: Statistics) -> Statistics:
        """What was counted of the RLAs that are new here comes with them; what they are worth, by their lessons."""
        both, new_ids = self._bringing.rlas, self._bringing.new_ids
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
        name = None if key is None else self._bringing.name_of(key)
        return expectation if name is None else replace(expectation, lesson=name)


def merge(
    path: Path, other: Path, borders: Radii, prefer: Side | None, *, teacher: str, stamp: str, dry_run: bool = False
) -> MergePlan:
    """Bring what was taught in `other` since both last met into `path`; durable on return, all or nothing.

    Where there are conflicts and no side is preferred, or `dry_run`, nothing is changed, and a robot may run on `path`
    meanwhile. Raises KnowledgeError, also for knowledge of other features or another task.
    """
    with Journal.read_only(path) as look:
        mine, saved = read_content(look), look.statistics()
    binding = mine.journal.binding
    with Journal.read_only(other) as look:
        require_compatible(look.binding, binding, other, look.has_lessons_at)
        theirs, of_theirs = read_content(look), look.statistics()
    planned = Merger(mine, theirs, borders, teacher=teacher, stamp=stamp).plan(saved, of_theirs, prefer)
    if not planned.entries or dry_run or (prefer is None and planned.conflicts):
        return planned
    both = replace(binding, levels={**theirs.journal.binding.levels, **binding.levels})
    with Journal.open(path, both) as journal:
        if tuple(journal.entries()) != mine.entries or journal.statistics() != saved:
            raise KnowledgeError("was taught in while it was looked at", where=path, do="merge again")
        write(journal, planned.entries, planned.statistics)
    return planned


def _says(rla: Rla) -> str:
    return f"{rla.title} says {rla.action}"


def _state(rla: Rla | None, rla_id: int) -> str:
    if rla is None:
        return f"{rla_title(rla_id, '')} is gone"
    return f"{rla.title} asks" if rla.is_withdrawn else _says(rla)
