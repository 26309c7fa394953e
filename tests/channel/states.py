"""Pictures of a robot for the stories of the channel."""

from dataclasses import replace
from typing import Any

from kurt2rt.channel.protocol.state import HoldState, MidState, ShownState, State, SurpriseState
from kurt2rt.core.decision.decision import DecisionCause, StandReason
from kurt2rt.core.decision.standing import DRIVES, Standing, standing_for
from kurt2rt.core.teaching.question import FeatureDifference
from simbridge.contracts.simulation import SimulatedPlace

ASKING = State(
    boot=b"boot",
    tick=1234,
    phase=2,
    infrared_counts=tuple(range(100, 118)),
    infrared_age_s=0.01,
    bumpers=0,
    left_m_s=0.0,
    right_m_s=0.0,
    cause="unknown",
    action=None,
    rla=None,
    nearest=12,
    nearest_action="forward",
    distance=812.5,
    radius=600.0,
    taught_by="phone",
    taught_at="2026-11-21T12:04:00Z",
    question=(FeatureDifference("front now", 410.0, 120.0), FeatureDifference("left mean", 90.0, 300.0)),
    teacher="phone",
    by_hand=False,
    stopped=None,
    rlas=12,
    lessons=14,
    unsaved=0,
    session="morning",
    clock_s=61.25,
    guard=(),
    trouble="",
    late_p99_ms=0.2,
    missed_ticks=0,
    place=SimulatedPlace(1.0, 2.0, 0.5, 0.25, 1, 3),
    standing=Standing(StandReason.ASKS, asks=True),
    way_m=(0.0, 0.0),
)
"""A simulated robot that stands and asks; `phone` is its teacher."""

COMMANDS = MidState(
    behaviour="turn_left",
    rla=12,
    nearest=12,
    nearest_behaviour="turn_left",
    distance=2.0,
    radius=6.0,
    taught_by="phone",
    taught_at="2026-11-21T12:04:00Z",
    asks=False,
    overridden=False,
    here=("left", "straight", "right", "straight", "left", "left", "straight", "", "", "", "", ""),
    there=("left", "straight", "left", "straight", "left", "straight", "straight", "", "", "", "", ""),
)
"""Mid-level RLA 12 has the robot turn left."""

SURPRISED = SurpriseState(tick=1230, level="mid", rla=12, follow_up=15, times=3.5, new=False)

SHOWN = ShownState(teacher="phone", press_id=91, actions=("forward", "back"), from_ticks=(800, 860), ticks=(60, 40))

HELD = HoldState(teacher="phone", action="turn_left", lesson="phone-hold-90", lessons=3, on=True)


def standing_in(state: State) -> Standing:
    """Return the standing of a robot that the guard does not hold, from the other fields of its state."""
    if state.action is not None and (state.by_hand or state.stopped is None):
        return DRIVES
    return standing_for(DecisionCause(state.cause), state.asks_at, state.stopped, state.plan_says or state.trouble)


def state(**changes: Any) -> State:
    """Return the state of an asking robot with some fields changed; its standing follows unless it is given."""
    shown = replace(ASKING, **changes)
    return shown if "standing" in changes else replace(shown, standing=standing_in(shown))
