"""Merge base of two knowledge files, and a three-way comparison of each lesson stack."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

from kurt2rt.core.rla.events import KnowledgeMerged, LessonRedone, LessonUndone
from kurt2rt.knowledge.journal.entry import StoredEntry
from kurt2rt.knowledge.versions.lesson_identity import (
    KnowledgeContent,
    LessonKey,
    StackKey,
    count_common_rows,
    lessons_up_to,
    standing_stacks,
)

Side = Literal["mine", "theirs"]


class Resolution(StrEnum):
    """Result of the comparison of one stack."""

    KEEP_MINE = "keep mine"
    TAKE_THEIRS = "take theirs"
    CONFLICT = "conflict"
    """Both files changed it."""


@dataclass(frozen=True, slots=True)
class MergeBase:
    """A moment at which one of both files contained all that the other one held."""

    mine: int
    """Rows of mine then, those that the merge wrote included."""
    theirs: int
    seen_in: Side
    """File whose lessons the other one saw."""

    def is_after(self, other: "MergeBase") -> bool:
        """Return whether this base is another one than `other` and includes all rows of `other` in both files."""
        return self != other and self.mine >= other.mine and self.theirs >= other.theirs


@dataclass(frozen=True)
class BaseState:
    """Knowledge that both files had at a merge base."""

    stacks: Mapping[StackKey, tuple[LessonKey, ...]]
    """Stacks as they stood in the file that was seen."""
    undone_here: frozenset[LessonKey]
    """Lessons that were undone in mine after it."""
    undone_there: frozenset[LessonKey]


@dataclass(frozen=True, slots=True)
class StackPair:
    """One stack as it stands in both files."""

    mine: tuple[LessonKey, ...]
    theirs: tuple[LessonKey, ...]

    @property
    def without_rewards(self) -> "StackPair":
        """Pair of the stacks without rewards."""
        return StackPair(without_rewards(self.mine), without_rewards(self.theirs))


def without_rewards(stack: Sequence[LessonKey]) -> tuple[LessonKey, ...]:
    """Return the lessons of a stack that are no rewards: only their order matters."""
    return tuple(key for key in stack if not key.is_reward)


def find_merge_bases(mine: Sequence[StoredEntry], theirs: Sequence[StoredEntry]) -> tuple[MergeBase, ...]:
    """Return the last common row or merge; two bases if each file was merged into an older state of the other.

    `mine` and `theirs`: all rows of the two files, in order.
    """
    common = count_common_rows(mine, theirs)
    found = [MergeBase(common, common, "mine")]
    for row, seen in _merges(mine, theirs):
        found.append(MergeBase(max(row, common), max(seen, common), "theirs"))
    for row, seen in _merges(theirs, mine):
        found.append(MergeBase(max(seen, common), max(row, common), "mine"))
    found = list({(each.mine, each.theirs): each for each in found}.values())
    return tuple(each for each in found if not any(other.is_after(each) for other in found))


def _merges(into: Sequence[StoredEntry], other: Sequence[StoredEntry]) -> list[tuple[int, int]]:
    """Return (row of `into`, rows of `other` then) for each merge of `other` into `into`."""
    return [
        (row, entry.event.rows)
        for row, entry in enumerate(into, start=1)
        if isinstance(entry.event, KnowledgeMerged)
        and entry.event.rows <= len(other)
        and other[entry.event.rows - 1].event.origin.command_id == entry.event.last
    ]


def base_state(base: MergeBase, mine: KnowledgeContent, theirs: KnowledgeContent) -> BaseState:
    """Return the lessons that both files knew at a merge base, and those that each file has undone since."""
    here, there = lessons_up_to(mine, base.mine), lessons_up_to(theirs, base.theirs)
    on_mine, on_theirs = standing_stacks(here, mine.lesson_keys), standing_stacks(there, theirs.lesson_keys)
    return BaseState(
        on_mine if base.seen_in == "mine" else on_theirs,
        undone_here=_undone_since(base.mine, mine),
        undone_there=_undone_since(base.theirs, theirs),
    )


def _undone_since(rows: int, content: KnowledgeContent) -> frozenset[LessonKey]:
    later = content.entries[rows:]
    return frozenset(
        content.lesson_keys[entry.event.lesson] for entry in later if isinstance(entry.event, LessonUndone)
    )


class ThreeWayDiff:
    """Changes of both files since their merge bases."""

    def __init__(self, mine: KnowledgeContent, theirs: KnowledgeContent) -> None:
        self._bases = [base_state(each, mine, theirs) for each in find_merge_bases(mine.entries, theirs.entries)]
        self._here, self._there = frozenset(mine.lesson_keys.values()), frozenset(theirs.lesson_keys.values())
        merged = (rows for _, rows in _merges(mine.entries, theirs.entries))
        seen = max([count_common_rows(mine.entries, theirs.entries), *merged])
        self._news = frozenset(
            theirs.lesson_keys[name]
            for entry in theirs.entries[seen:]
            for name in (
                entry.event.lesson if isinstance(entry.event, LessonRedone) else entry.event.origin.command_id,
            )
            if name in theirs.lesson_keys
        )
        """Lessons taught or redone there after the last row that mine has seen."""
        self._undone_unseen = _undone_since(seen, theirs)
        """Lessons undone there after the last row that mine has seen."""

    def resolution_of(self, stack: StackKey, sides: StackPair) -> Resolution:
        """Return whether a stack of mine stays, becomes as in theirs, or is a conflict; rewards do not count.

        `stack`: its key. `sides`: its lessons in both files.
        """
        sides = sides.without_rewards
        found = {self._since(without_rewards(base.stacks.get(stack, ())), base, sides) for base in self._bases}
        return found.pop() if len(found) == 1 else Resolution.CONFLICT

    def new_rewards(self, sides: StackPair) -> tuple[LessonKey, ...]:
        """Return the rewards of a stack that were given or redone in theirs since the merge bases."""
        rewards = [key for key in sides.theirs if key.is_reward and key not in sides.mine]
        return tuple(key for key in rewards if all(self._is_new(key, base) for base in self._bases))

    def withdrawn_rewards(self, sides: StackPair) -> tuple[LessonKey, ...]:
        """Return the rewards of a stack that stand in mine and were undone in theirs since the merge bases."""
        rewards = [
            key for key in sides.mine if key.is_reward and key not in sides.theirs and key in self._undone_unseen
        ]
        return tuple(
            key
            for key in rewards
            if any(key in base.stacks.get(key.stack, ()) or key in base.undone_there for base in self._bases)
        )

    def _is_new(self, key: LessonKey, base: BaseState) -> bool:
        if key in base.stacks.get(key.stack, ()):
            return False  # undone here since, or left out
        if key not in self._here:
            return True
        # An undo counts also for a lesson that came here by a third file. A lesson that they kept, although it was
        # undone here, is not new.
        return key not in base.undone_here and key in self._news

    def _since(self, before: tuple[LessonKey, ...], base: BaseState, sides: StackPair) -> Resolution:
        """Return the resolution of a stack that was `before` at one base."""
        mine, theirs = sides.mine, sides.theirs
        if mine == theirs:
            return Resolution.KEEP_MINE
        # A lesson that came by a third file and was undone since is a change that the stacks do not show.
        undone_there = base.undone_there & (set(mine) - set(theirs))
        undone_here = base.undone_here & (set(theirs) - set(mine))
        if theirs == before and not undone_there:
            return Resolution.KEEP_MINE
        if mine == before and not undone_here:
            return Resolution.TAKE_THEIRS
        if _extends(theirs, mine, self._here | frozenset(before)):
            return Resolution.TAKE_THEIRS
        return Resolution.KEEP_MINE if _extends(mine, theirs, self._there | frozenset(before)) else Resolution.CONFLICT


def _extends(longer: tuple[LessonKey, ...], shorter: tuple[LessonKey, ...], known: frozenset[LessonKey]) -> bool:
    """Return whether `longer` is `shorter` with further lessons on top, none of them `known` to the other file."""
    size = len(shorter)
    return longer[:size] == shorter and not known.intersection(longer[size:])
