"""When two knowledge files last knew of each other: what changed since then changed on one side, or on both."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from kurt2rt.core.rla.rla import KnowledgeMerged, LessonRedone, LessonUndone
from kurt2rt.knowledge.journal.entry import StoredEntry
from kurt2rt.knowledge.versions.lesson_identity import (
    KnowledgeContent,
    LessonKey,
    StackKey,
    common_rows,
    lessons_up_to,
    standing_stacks,
)

Side = Literal["mine", "theirs"]
Resolution = Literal["stays", "as there", "both"]
"""What becomes of a pile here; both: it changed on both sides."""


@dataclass(frozen=True, slots=True)
class MergeBase:
    """A moment at which one of them took account of all that the other one held."""

    mine: int
    """Rows of mine then, what was brought in among them."""
    theirs: int
    seen_in: Side
    """Whose lessons the other one saw."""

    def is_after(self, other: "MergeBase") -> bool:
        """Whether it knew all that was known at the other one."""
        return self != other and self.mine >= other.mine and self.theirs >= other.theirs


@dataclass(frozen=True)
class BaseState:
    """What both knew at a meeting."""

    stacks: Mapping[StackKey, tuple[LessonKey, ...]]
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


def lessons_of(stack: Sequence[LessonKey]) -> tuple[LessonKey, ...]:
    """The lessons of a pile that are neither praise nor blame: those whose order matters."""
    return tuple(key for key in stack if not key.is_reward)


def find_merge_bases(mine: Sequence[StoredEntry], theirs: Sequence[StoredEntry]) -> tuple[MergeBase, ...]:
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


def base_state(meeting: MergeBase, mine: KnowledgeContent, theirs: KnowledgeContent) -> BaseState:
    """What both knew at that meeting."""
    here, there = lessons_up_to(mine, meeting.mine), lessons_up_to(theirs, meeting.theirs)
    on_mine, on_theirs = standing_stacks(here, mine.lesson_keys), standing_stacks(there, theirs.lesson_keys)
    return BaseState(
        on_mine if meeting.seen_in == "mine" else on_theirs,
        undone_here=_undone_since(meeting.mine, mine),
        undone_there=_undone_since(meeting.theirs, theirs),
    )


def _undone_since(rows: int, taught: KnowledgeContent) -> frozenset[LessonKey]:
    later = taught.entries[rows:]
    return frozenset(taught.lesson_keys[entry.event.lesson] for entry in later if isinstance(entry.event, LessonUndone))


class ThreeWayDiff:
    """How both went on since they met."""

    def __init__(self, mine: KnowledgeContent, theirs: KnowledgeContent) -> None:
        self._bases = [base_state(each, mine, theirs) for each in find_merge_bases(mine.entries, theirs.entries)]
        self._here, self._there = frozenset(mine.lesson_keys.values()), frozenset(theirs.lesson_keys.values())
        heard = max(
            [common_rows(mine.entries, theirs.entries), *(rows for _, rows in _merges(mine.entries, theirs.entries))]
        )
        self._news = frozenset(
            theirs.lesson_keys[name]
            for entry in theirs.entries[heard:]
            for name in (
                entry.event.lesson if isinstance(entry.event, LessonRedone) else entry.event.origin.command_id,
            )
            if name in theirs.lesson_keys
        )
        """Lessons that were taught there, or stand there again, and of which mine did not hear yet."""
        self._taken_back = _undone_since(heard, theirs)
        """Lessons that were undone there, of which mine did not hear yet."""

    def resolve(self, stack: StackKey, sides: StackPair) -> Resolution:
        """Who changed the lessons of a pile, praise and blame apart."""
        sides = sides.without_rewards
        found = {self._side_resolution(lessons_of(base.stacks.get(stack, ())), base, sides) for base in self._bases}
        return found.pop() if len(found) == 1 else "both"

    def new_rewards(self, sides: StackPair) -> tuple[LessonKey, ...]:
        """Praise and blame that are new there, or stand there again."""
        rewards = [key for key in sides.theirs if key.is_reward and key not in sides.mine]
        return tuple(key for key in rewards if all(self._came(key, base) for base in self._bases))

    def withdrawn_rewards(self, sides: StackPair) -> tuple[LessonKey, ...]:
        """Praise and blame that stand here and were taken back there."""
        rewards = [key for key in sides.mine if key.is_reward and key not in sides.theirs and key in self._taken_back]
        return tuple(
            key
            for key in rewards
            if any(key in base.stacks.get(key.stack, ()) or key in base.undone_there for base in self._bases)
        )

    def _came(self, key: LessonKey, base: BaseState) -> bool:
        if key in base.stacks.get(key.stack, ()):
            return False  # it was undone here since, or left out
        if key not in self._here:
            return True
        # Of one that came here on another way the undo counts; one that they kept although it was undone is not new.
        return key not in base.undone_here and key in self._news

    def _side_resolution(self, before: tuple[LessonKey, ...], base: BaseState, sides: StackPair) -> Resolution:
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
