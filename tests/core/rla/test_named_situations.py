"""Named situations."""

import math

from kurt2rt.core.rla.condition import Space
from kurt2rt.core.rla.events import EventFault
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.rla.rla_system import RlaSystem
from tests.core.rla.helpers import named, refused_by


def system() -> RlaSystem:
    return RlaSystem(2, 5.0, others={MID: Space(3, 0.5)})


def test_named_situation_unfit_for_level_is_refused() -> None:
    knows = system()
    assert refused_by(knows, named("door", (1.0, 2.0), MID)).fault is EventFault.BAD_SITUATION
    assert refused_by(knows, named("door", (1.0, math.nan, 0.0), MID)).fault is EventFault.NOT_FINITE
    assert knows.history.records == ()
