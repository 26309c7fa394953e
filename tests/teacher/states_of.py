"""Waiting for what a robot shows."""

from collections.abc import Callable

import anyio

from kurt2rt.channel.protocol.state import State
from kurt2rt.teacher import TeacherClient
from tests.patience import PATIENCE_S


async def state_where(robot: TeacherClient, true: Callable[[State], bool] = lambda _: True, **wanted: object) -> State:
    """Return the first state that the predicate accepts and that has these values."""
    with anyio.fail_after(PATIENCE_S):
        async for state in robot.states():
            if true(state) and all(getattr(state, name) == value for name, value in wanted.items()):
                return state
    raise AssertionError("the client ended")
