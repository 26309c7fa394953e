"""Named situations."""

import math

from kurt2rt.core.outcome import RefusalCode
from kurt2rt.core.rla.condition import Space
from kurt2rt.core.rla.event_error import EventFault
from kurt2rt.core.rla.lesson_history import lesson_stack
from kurt2rt.core.rla.rla import BASIC, MID
from kurt2rt.core.rla.rla_system import RlaSystem
from tests.core.rla.helpers import created, named, refused_by, undone


def system() -> RlaSystem:
    return RlaSystem(2, 5.0, others={MID: Space(3, 0.5)})


def test_named_situation_belongs_to_its_level() -> None:
    knows = system()
    knows.apply_all([named("door", (1.0, 2.0, 0.0), MID), named("post", (7.0, 8.0))])
    assert knows.named_situations(MID) == {"door": (1.0, 2.0, 0.0)}
    assert knows.named_situations(BASIC) == {"post": (7.0, 8.0)}
    assert [lesson_stack(record.event) for record in knows.lessons] == [(MID, "door"), (BASIC, "post")]


def test_named_situation_newer_one_counts_until_undone() -> None:
    knows = system()
    knows.apply_all([named("door", (1.0, 2.0, 0.0), MID), named("door", (5.0, 5.0, 0.0), MID, "moved")])
    assert knows.named_situations(MID)["door"] == (5.0, 5.0, 0.0)
    refusal = knows.why_not_undo("naming-door")
    assert refusal is not None
    assert refusal.code is RefusalCode.TAUGHT_AFTER
    knows.apply(undone("moved"))
    assert knows.named_situations(MID)["door"] == (1.0, 2.0, 0.0)
    knows.apply(undone("naming-door"))
    assert knows.named_situations(MID) == {}
    assert [record.undone for record in knows.lessons] == [True, True]


def test_named_situation_changes_no_rla_or_hash() -> None:
    knows = system()
    knows.apply(created(1, (0.0, 0.0)))
    before = knows.knowledge_hash()
    knows.apply(named("door", (1.0, 2.0, 0.0), MID))
    assert knows.knowledge_hash() == before
    assert knows.next_id == 2


def test_named_situation_unfit_for_level_is_refused() -> None:
    knows = system()
    assert refused_by(knows, named("door", (1.0, 2.0), MID)).fault is EventFault.BAD_SITUATION
    assert refused_by(knows, named("door", (1.0, math.nan, 0.0), MID)).fault is EventFault.NOT_FINITE
    assert knows.lessons == ()
