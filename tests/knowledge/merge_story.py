"""Random stories of files that are taught and merged, and a model of what each file must hold.

The model has no rows, stacks or ids: of each lesson only the last decision that it stands or not, and of each file the
decisions that it has seen. Ticks identify lessons.
"""

import math
import random
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from kurt2rt.core.rla.credit import Credit
from kurt2rt.core.rla.events import (
    ActionReplaced,
    ActionWithdrawn,
    KnowledgeMerged,
    LessonRedone,
    LessonUndone,
    RlaCreated,
    RlaDeleted,
    RlaRewarded,
    SessionEnded,
    SituationNamed,
    TeachingEvent,
)
from kurt2rt.core.rla.lesson_history import lesson_stack
from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.rla.rla import BASIC, Origin, Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.space import Space
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.journal.entry import StoredEntry
from kurt2rt.knowledge.journal.fold import fold_entries
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.versions.contradictions import Radii
from kurt2rt.knowledge.versions.lesson_identity import KnowledgeContent
from kurt2rt.knowledge.versions.merge import MergePlan, Merger, Side
from tests.knowledge.lessons import STAMP

BORDERS = Radii({BASIC: Space(4, 10.0)}, {BASIC: 0.2})
ACTIONS = ("forward", "left", "right")
KINDS = (
    ("create",) * 3 + ("replace",) * 2 + ("withdraw", "delete") + ("reward",) * 3 + ("name",) * 2
    + ("undo",) * 3 + ("redo",) * 2 + ("session",)
)  # fmt: skip


class Decision(NamedTuple):
    """Decision of a teacher that a lesson stands, or does not."""

    number: int
    stands: bool


@dataclass
class File:
    """A knowledge file in memory, and what the model knows of it."""

    entries: list[StoredEntry] = field(default_factory=list)
    decisions: dict[int, Decision] = field(default_factory=dict)
    """The last one of each lesson, by its tick."""
    heard_of: set[int] = field(default_factory=set)
    """All decisions that ever came to it."""

    def write(self, event: TeachingEvent, stamp: str = STAMP) -> None:
        assert event.origin.command_id not in {entry.event.origin.command_id for entry in self.entries}
        self.entries.append(StoredEntry(len(self.entries) + 1, event, stamp))

    def stands(self, tick: int) -> bool:
        return tick in self.decisions and self.decisions[tick].stands


class Story:
    """Files that began as one."""

    def __init__(self, seed: int, journal: Journal, names: str = "ab") -> None:
        """`journal`: closed; whose binding all of them have. `names`: one letter for each file."""
        self.told: list[str] = []
        """What happened, for who reads of a story that went wrong."""
        self._random = random.Random(seed)
        self._journal = journal
        self._count = 0
        first = File()
        self._names = names
        self.files = {names[0]: first}
        self.teach(names[0], self._random.randint(0, 8))
        for name in names[1:]:
            self.files[name] = File(list(first.entries), dict(first.decisions), set(first.heard_of))

    def go_on(self) -> None:
        """One thing happens: a lesson or some, or a merge."""
        mine, theirs = self._random.sample(self._names, 2)
        if self._random.random() < 0.5:
            self.teach(mine, self._random.randint(1, 5))
        else:
            self.merge(mine, theirs, self._random.choice((None, None, "mine", "theirs")))

    def read(self, name: str) -> KnowledgeContent:
        entries = tuple(self.files[name].entries)
        return KnowledgeContent(self._journal, entries, fold_entries(self._journal, entries, radius=math.inf))

    def teach(self, name: str, lessons: int) -> None:
        file, system = self.files[name], self.read(name).system
        for _ in range(lessons):
            event = self._anything(system)
            if event is None:
                continue
            system.apply(event)
            file.write(event)
            if isinstance(event, SessionEnded | KnowledgeMerged):
                continue
            undone = isinstance(event, LessonUndone)
            if isinstance(event, LessonUndone | LessonRedone):
                record = system.lesson(event.lesson)
                assert record is not None
                tick = record.event.origin.tick
            else:
                tick = event.origin.tick
            file.decisions[tick] = self._decision(file, stands=not undone)
            self.told.append(f"{name}: {type(event).__name__} {tick}")

    def merge(self, mine: str, theirs: str, prefer: Side | None) -> MergePlan:
        """Merge, and hold what came of it against the model."""
        before, there = self.read(mine), self.read(theirs)
        mine_outcomes, their_outcomes = _outcomes(before.system), _outcomes(there.system)
        held = _piles(before.system)
        planned = self._plan(before, there, prefer)
        self.told.append(f"{mine} <- {theirs}, prefer {prefer}: {planned.conflicts} {planned.left_out}")
        if planned.conflicts and prefer is None:
            return planned
        file, other = self.files[mine], self.files[theirs]
        for entry in planned.entries:
            file.write(entry.event, entry.stamped_at)
        after = self.read(mine)
        again = self._plan(self.read(mine), self.read(theirs), prefer)
        assert (again.entries, again.conflicts) == ((), ()), "twice is not as once"
        stands = _standing(after.system)
        same = {pile for pile, outcome in mine_outcomes.items() if outcome == their_outcomes.get(pile)}
        piles = {**_piles(before.system), **_piles(there.system)}
        rewards = _rewards(before.system) | _rewards(there.system)
        for tick in sorted({*file.decisions, *other.decisions} & piles.keys()):
            wanted = _wanted(file, other, tick)
            if tick in rewards:
                excused = bool(planned.left_out) or (tick not in file.decisions and wanted is False)
            else:
                excused = piles[tick] in same
            if len(self._names) > 2:  # no trace comes of what was undone before it came by way of a third file
                excused |= wanted is not False or tick not in held or file.stands(tick)
            if not planned.conflicts and not excused and wanted is not None:
                assert (tick in stands) == wanted, f"lesson {tick} should {'stand' if wanted else 'not stand'}"
        if planned.entries:
            here = {record.event.origin.tick for record in after.system.lessons}
            self._add_decisions(file, other, stands, here, rewards, settled=bool(planned.conflicts))
        return planned

    def _plan(self, mine: KnowledgeContent, theirs: KnowledgeContent, prefer: Side | None) -> MergePlan:
        merging = Merger(mine, theirs, BORDERS, teacher="command line", stamp=STAMP)
        return merging.plan(Statistics(), Statistics(), prefer)

    def _add_decisions(
        self, file: File, other: File, stands: set[int], here: set[int], rewards: set[int], *, settled: bool
    ) -> None:
        """Add the decisions of `other`, and those of the merge itself, to `file`."""
        for tick in {*file.decisions, *other.decisions}:
            stood = tick in stands
            theirs, mine = other.decisions.get(tick), file.decisions.get(tick)
            decided = settled and tick not in rewards  # one that stays under a correction is no decision, and is told
            if tick not in here and tick in rewards:
                continue  # left out: no decision that it shall not stand there
            if theirs is not None and theirs.stands == stood and theirs.number not in file.heard_of:
                file.decisions[tick] = theirs
            elif mine is None or mine.stands != stood or (decided and theirs is not None and theirs.stands != stood):
                file.decisions[tick] = self._decision(file, stands=stood)
        file.heard_of |= other.heard_of

    def _decision(self, file: File, *, stands: bool) -> Decision:
        self._count += 1
        file.heard_of.add(self._count)
        return Decision(self._count, stands)

    def _anything(self, system: RlaSystem) -> TeachingEvent | None:
        """Return a random event that fits, or None if none of its kind does."""
        chance = self._random
        self._count += 1
        # Some command ids come twice, in different files.
        own = f"c{self._count}" if chance.random() < 0.9 else f"twice-{chance.randint(0, 3)}"
        if system.lesson(own) is not None:
            own = f"c{self._count}"
        origin = Origin(own, chance.choice(("Hertha", "Joachim", "critic")), Phase.CORRECTIONS, self._count)
        kind, living = chance.choice(KINDS), sorted(system.active_rlas, key=lambda rla: rla.rla_id)
        ids = [record.event.origin.command_id for record in system.lessons]
        match kind:
            case "create":
                place = (100.0 * self._count, 0.0, 0.0, 0.0)
                return RlaCreated(Rla(system.next_id, place, chance.choice(ACTIONS), None, origin))
            case "name":
                return SituationNamed(chance.choice(("home", "door")), (float(self._count), 0, 0, 0), BASIC, origin)
            case "session":
                return SessionEnded(self._count, replace(origin, command_id=f"c{self._count}"))
            case "undo":
                ids = [each for each in ids if system.why_not_undo(each) is None]
                return LessonUndone(chance.choice(ids), replace(origin, command_id=f"c{self._count}")) if ids else None
            case "redo":
                ids = [each for each in ids if system.why_not_redo(each) is None]
                return LessonRedone(chance.choice(ids), replace(origin, command_id=f"c{self._count}")) if ids else None
        if not living:
            return None
        rla = chance.choice(living)
        match kind:
            case "replace":
                action = chance.choice([action for action in ACTIONS if action != rla.action])
                return ActionReplaced(rla.rla_id, action, rla.action, origin)
            case "withdraw":
                return None if rla.is_withdrawn else ActionWithdrawn(rla.rla_id, rla.action, origin)
            case "delete":
                return RlaDeleted(rla.rla_id, origin)
        credits_ = tuple(Credit(each.rla_id, -0.5) for each in living[:2])
        return RlaRewarded(rla.rla_id, chance.choice((1, -1)), 3, origin, credits_)


def _wanted(file: File, other: File, tick: int) -> bool | None:
    """Return whether a lesson shall stand here; None if each side decided without the other."""
    theirs, mine = other.decisions.get(tick), file.decisions.get(tick)
    if theirs is None or theirs.number in file.heard_of:
        return file.stands(tick)
    if mine is None or mine.number in other.heard_of:
        return theirs.stands
    return None


def _standing(system: RlaSystem) -> set[int]:
    ticks = [record.event.origin.tick for record in system.lessons if not record.undone]
    assert len(set(ticks)) == len(ticks), "a lesson stands twice"
    return set(ticks)


def _rewards(system: RlaSystem) -> set[int]:
    return {record.event.origin.tick for record in system.lessons if isinstance(record.event, RlaRewarded)}


def _piles(system: RlaSystem) -> dict[int, object]:
    """Return what each lesson is about, by its tick: a name, or the tick of the lesson that created its RLA."""
    created = {
        record.event.rla.rla_id: record.event.origin.tick
        for record in system.lessons
        if isinstance(record.event, RlaCreated)
    }
    return {
        record.event.origin.tick: pile if isinstance(pile := lesson_stack(record.event), tuple) else created[pile]
        for record in system.lessons
    }


def _outcomes(system: RlaSystem) -> Mapping[object, object]:
    """Return the result of each stack: the action of an RLA, the place of a name."""
    about, outcomes = _piles(system), dict[object, object]()
    for record in system.lessons:
        pile = lesson_stack(record.event)
        rla = system.get(pile) if isinstance(pile, int) else None
        outcome = (rla and rla.action) if isinstance(pile, int) else system.named_situations(pile[0]).get(pile[1])
        outcomes[about[record.event.origin.tick]] = outcome
    return outcomes
