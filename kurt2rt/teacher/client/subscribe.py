"""Subscription to the robot's states, renewed whenever an observation ends or falls silent."""

from collections.abc import Callable

import anyio

from kurt2rt.channel.protocol.codec import WireError, decode_state
from kurt2rt.teacher.client.state_stream import StateStream
from kurt2rt.teacher.client.transport import OscoreRequests, Response

SILENT_AFTER_S = 1.0
"""Time without a state after which the observation is registered again."""
_POLL_S = 0.1
_STATE = "/state"


async def subscribe(requests: OscoreRequests, stream: StateStream, now: Callable[[], float]) -> None:
    """Fill `stream` until cancelled; `now` is a monotonic clock in seconds."""
    while True:
        before, began_s, newest = stream.count, now(), -2

        def on_response(response: Response) -> None:
            nonlocal newest
            # Drops replayed states, and states that a newer one overtook.
            if response.number <= newest:
                return
            newest = response.number
            _publish(response, requests, stream)

        observation = requests.observe(_STATE, on_response)
        while True:
            await anyio.sleep(_POLL_S)
            came = stream.count > before
            if observation.ended and came:
                break
            if now() - began_s > SILENT_AFTER_S and stream.age_s > SILENT_AFTER_S:
                break
        observation.end()
        if stream.count == before:
            await requests.find_robot()  # it may have another address by now


def _publish(response: Response, requests: OscoreRequests, stream: StateStream) -> None:
    if not response.successful:
        requests.trouble = f"the robot shows no picture: {response.code}"
        return
    try:
        state = decode_state(response.payload)
    except WireError as error:
        requests.trouble = (
            f"the robot's picture is not understood, it may be of another version: {error}; install the same kurt2rt "
            "on the robot and on this device"
        )
    else:
        stream.publish(state)
