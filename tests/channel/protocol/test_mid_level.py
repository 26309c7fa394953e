"""A robot with a mid level, as its teachers see it over the wire: lessons, overrides, goals and surprise."""

import pytest

from kurt2rt.channel.protocol.requests import SituationsRequest
from kurt2rt.channel.protocol.state import SurpriseState
from kurt2rt.channel.server.reply import ReplyStatus
from kurt2rt.core.decision.decision import GoalStatus, PlanStep
from kurt2rt.core.decision.goal import NamedGoal, PartialGoal, RlaGoal
from kurt2rt.core.expectations.expectations import Surprise
from kurt2rt.core.outcome import Outcome, ResultCode
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.teaching.commands import BeAt, NameSituation, Seek, StopSeeking, Teach, Undo
from tests.channel.channel_fixture import ChannelFixture, outcome_of, why
from tests.channel.grounds import Yard

TURNS = ("straight_on", "turn_left", "turn_right")


@pytest.fixture
def desk() -> ChannelFixture:
    return ChannelFixture(behaviours=TURNS, mid="turns", ground=Yard())


async def test_situations_are_named_listed_sought_and_undone(desk: ChannelFixture) -> None:
    await desk.ask(desk.command(Teach, "turn_left", None, MID, False))
    assert (await desk.ask(SituationsRequest())).body == {"situations": ()}
    reply = await desk.ask(desk.command(NameSituation, "door", None))
    assert outcome_of(reply) == Outcome.of(ResultCode.SITUATION_NAMED, name="door")
    assert (await desk.ask(SituationsRequest())).body == {"situations": ("door",)}
    await desk.ask(desk.answer("forward"))
    assert (await desk.ask(desk.command(Seek, NamedGoal("door")))).status is ReplyStatus.DONE
    await desk.stream(desk.watch())
    desk.run()
    told = desk.picture
    assert (told.goal, told.plan) == ("door", ())
    assert "door" in told.plan_says
    step = PlanStep("door", GoalStatus.UNDER_WAY, ("turn_left", "straight_on"), 1, "on the way to door: 2 ways left", 0)
    under_way = desk.record._replace(decision=desk.record.decision._replace(plan=step))
    told = desk.channel._states.build(under_way)
    assert (told.goal, told.plan, told.plan_says) == ("door", step.behaviours, step.says)
    assert outcome_of(await desk.ask(desk.command(StopSeeking))) == Outcome(ResultCode.GOAL_DROPPED)
    desk.run()
    assert (desk.picture.goal, desk.picture.plan_says) == ("", "")
    assert (await desk.ask(desk.command(Seek, RlaGoal(1)))).status is ReplyStatus.DONE
    assert "1" in desk.picture.goal
    for request in (
        desk.command(Seek, NamedGoal("window")),
        desk.command(Seek, RlaGoal(77)),
        desk.command(Seek, PartialGoal((("height", 1.0),), 0.1)),
        desk.command(BeAt, "window"),
    ):
        assert why(await desk.ask(request)) == "refused"
    for _ in range(2):  # how to turn left, and the name
        await desk.ask(desk.command(Undo, None))
    assert (await desk.ask(SituationsRequest())).body == {"situations": ()}


async def test_surprise_between_states_is_told(desk: ChannelFixture) -> None:
    assert desk.picture.surprise is None
    usual = Surprise(MID, 1, 2, 1.0, 1.0, 9, 4, False)
    far = Surprise(MID, 1, 3, 6.0, 2.0, 9, 0, True)
    desk.channel._states.on_tick(desk.record._replace(surprise=far))
    desk.run(3)
    desk.channel._states.on_tick(desk.record._replace(surprise=usual))
    assert desk.picture.surprise == SurpriseState(desk.tick - 3, MID, 1, 3, 3.0, True)
