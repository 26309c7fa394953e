"""When two knowledge files last knew of each other: what changed since then changed on one side, or on both."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from kurt2rt.core.rla.rla import KnowledgeMerged, LessonRedone, LessonUndone
from kurt2rt.knowledge.journal.entry import StoredEntry
from kurt2rt.knowledge.versions.lesson_identity import (
    KnowledgeContent,
    LessonKey,
    PileMark,
    common_rows,
    lessons_up_to,
    standing_piles,
)

Side = Literal["mine", "theirs"]
Way = Literal["stays", "as there", "both"]
"""What becomes of a pile here; both: it changed on both sides."""


@dataclass(frozen=True, slots=True)
class MergeBase:
    """A moment at which one of them took account of all that the other one held."""

    mine: int
    """Rows of mine then, what was brought in among them."""
    theirs: int
    shown: Side
    """Whose lessons the other one saw."""

    def is_after(self, other: "MergeBase") -> bool:
        """Whether it knew all that was known at the other one."""
        return self != other and self.mine >= other.mine and self.theirs >= other.theirs


@dataclass(frozen=True)
class BaseState:
    """What both knew at a meeting."""

    piles: Mapping[PileMark, tuple[LessonKey, ...]]
    """As they stood in the file that was shown."""
    undone_here: frozenset[LessonKey]
    """Lessons that were undone in mine after it."""
    undone_there: frozenset[LessonKey]


@dataclass(frozen=True, slots=True)
class StackPair:
    """One pile as it stands in both files."""

    mine: tuple[LessonKey, ...]
    theirs: tuple[LessonKey, ...]

    @property
    def without_rewards(self) -> "StackPair":
        """Praise and blame left out."""
        return StackPair(lessons_of(self.mine), lessons_of(self.theirs))


def lessons_of(pile: Sequence[LessonKey]) -> tuple[LessonKey, ...]:
    """The lessons of a pile that are neither praise nor blame: those whose order matters."""
    return tuple(mark for mark in pile if not mark.is_reward)


def last_meetings(mine: Sequence[StoredEntry], theirs: Sequence[StoredEntry]) -> tuple[MergeBase, ...]:
    """Where they parted, or the last merge of one into the other; two where each was merged into an older other."""
    common = common_rows(mine, theirs)
    found = [MergeBase(common, common, "mine")]
    for row, seen in _merges(mine, theirs):
        found.append(MergeBase(max(row, common), max(seen, common), "theirs"))
    for row, seen in _merges(theirs, mine):
        found.append(MergeBase(max(seen, common), max(row, common), "mine"))
    found = list({(each.mine, each.theirs): each for each in found}.values())
    return tuple(each for each in found if not any(other.is_after(each) for other in found))


def _merges(into: Sequence[StoredEntry], other: Sequence[StoredEntry]) -> list[tuple[int, int]]:
    """Rows of `into` that say that `other` was brought in there, and how many rows that had."""
    return [
        (row, entry.event.rows)
        for row, entry in enumerate(into, start=1)
        if isinstance(entry.event, KnowledgeMerged)
        and entry.event.rows <= len(other)
        and other[entry.event.rows - 1].event.origin.command_id == entry.event.last
    ]


def base_of(meeting: MergeBase, mine: KnowledgeContent, theirs: KnowledgeContent) -> BaseState:
    """What both knew at that meeting."""
    here, there = lessons_up_to(mine, meeting.mine), lessons_up_to(theirs, meeting.theirs)
    on_mine, on_theirs = standing_piles(here, mine.marks), standing_piles(there, theirs.marks)
    return BaseState(
        on_mine if meeting.shown == "mine" else on_theirs,
        undone_here=_undone_since(meeting.mine, mine),
        undone_there=_undone_since(meeting.theirs, theirs),
    )


def _undone_since(rows: int, taught: KnowledgeContent) -> frozenset[LessonKey]:
    later = taught.entries[rows:]
    return frozenset(taught.marks[entry.event.lesson] for entry in later if isinstance(entry.event, LessonUndone))


class ThreeWayDiff:
    """How both went on since they met."""

    def __init__(self, mine: KnowledgeContent, theirs: KnowledgeContent) -> None:
        self._bases = [base_of(each, mine, theirs) for each in last_meetings(mine.entries, theirs.entries)]
        self._here, self._there = frozenset(mine.marks.values()), frozenset(theirs.marks.values())
        heard = max(
            [common_rows(mine.entries, theirs.entries), *(rows for _, rows in _merges(mine.entries, theirs.entries))]
        )
        self._news = frozenset(
            theirs.marks[name]
            for entry in theirs.entries[heard:]
            for name in (
                entry.event.lesson if isinstance(entry.event, LessonRedone) else entry.event.origin.command_id,
            )
            if name in theirs.marks
        )
        """Lessons that were taught there, or stand there again, and of which mine did not hear yet."""
        self._taken_back = _undone_since(heard, theirs)
        """Lessons that were undone there, of which mine did not hear yet."""

    def way_of(self, pile: PileMark, sides: StackPair) -> Way:
        """Who changed the lessons of a pile, praise and blame apart."""
        sides = sides.without_rewards
        ways = {self._way(lessons_of(base.piles.get(pile, ())), base, sides) for base in self._bases}
        return ways.pop() if len(ways) == 1 else "both"

    def rewards_that_came(self, sides: StackPair) -> tuple[LessonKey, ...]:
        """Praise and blame that are new there, or stand there again."""
        rewards = [mark for mark in sides.theirs if mark.is_reward and mark not in sides.mine]
        return tuple(mark for mark in rewards if all(self._came(mark, base) for base in self._bases))

    def rewards_that_went(self, sides: StackPair) -> tuple[LessonKey, ...]:
        """Praise and blame that stand here and were taken back there."""
        rewards = [
            mark for mark in sides.mine if mark.is_reward and mark not in sides.theirs and mark in self._taken_back
        ]
        return tuple(
            mark
            for mark in rewards
            if any(mark in base.piles.get(mark.pile, ()) or mark in base.undone_there for base in self._bases)
        )

    def _came(self, mark: LessonKey, base: BaseState) -> bool:
        if mark in base.piles.get(mark.pile, ()):
            return False  # it was undone here since, or left out
        if mark not in self._here:
            return True
        # Of one that came here on another way the undo counts; one that they kept although it was undone is not new.
        return mark not in base.undone_here and mark in self._news

    def _way(self, before: tuple[LessonKey, ...], base: BaseState, sides: StackPair) -> Way:
        mine, theirs = sides.mine, sides.theirs
        if mine == theirs:
            return "stays"
        # A lesson that came on another way than this meeting, and was undone since, was changed although nothing shows.
        undone_there = base.undone_there & (set(mine) - set(theirs))
        undone_here = base.undone_here & (set(theirs) - set(mine))
        if theirs == before and not undone_there:
            return "stays"
        if mine == before and not undone_here:
            return "as there"
        if _goes_on(theirs, mine, self._here | frozenset(before)):
            return "as there"
        return "stays" if _goes_on(mine, theirs, self._there | frozenset(before)) else "both"


def _goes_on(longer: tuple[LessonKey, ...], shorter: tuple[LessonKey, ...], known: frozenset[LessonKey]) -> bool:
    """Whether one is the other and more, of which that one's file never heard."""
    size = len(shorter)
    return longer[:size] == shorter and not known.intersection(longer[size:])
