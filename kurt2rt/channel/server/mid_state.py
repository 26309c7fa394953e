"""Mid level and surprise in the state of the robot."""

import math
from collections.abc import Callable

from kurt2rt.channel.protocol.state import MidState, SurpriseState
from kurt2rt.core.decision.decision import MidDecision
from kurt2rt.core.mid.mid_level import MidLevel
from kurt2rt.core.tick_record import TickRecord


def mid_state(mid: MidLevel, decided: MidDecision, stamp_of: Callable[[str], str]) -> MidState:
    """Return the mid level's command and its reason; `stamp_of`: the time when a command's lesson became durable."""
    settings, match = mid.settings, decided.match
    nearest = None if match is None else match.rla
    words = settings.situation.describe
    return MidState(
        behaviour=decided.behaviour,
        rla=decided.rla_id,
        nearest=None if nearest is None else nearest.rla_id,
        nearest_behaviour=None if nearest is None else nearest.action,
        distance=math.inf if match is None else match.distance,
        radius=settings.learning.radius if match is None else match.radius,
        taught_by="" if nearest is None else nearest.origin.teacher,
        taught_at="" if nearest is None else stamp_of(nearest.origin.command_id),
        asks=decided.asks,
        overridden=decided.overridden,
        here=words(mid.vector),
        there=() if nearest is None else words(nearest.condition),
    )


def surprise_state(record: TickRecord) -> SurpriseState | None:
    """Return the surprise of a tick; None if there is none."""
    surprise = record.surprise
    if surprise is None or not surprise.surprising:
        return None
    return SurpriseState(
        tick=record.tick,
        level=surprise.level,
        rla=surprise.rla_id,
        follow_up=surprise.follow_up,
        times=surprise.multiple,
        new=surprise.new_follow_up,
    )
