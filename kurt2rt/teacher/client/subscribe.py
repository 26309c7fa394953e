"""How a teacher's device keeps seeing the robot: one observation after the other, for as long as it wants."""

from collections.abc import Callable

import anyio

from kurt2rt.channel.protocol.codec import WireError, decode_state
from kurt2rt.teacher.client.state_stream import StateStream
from kurt2rt.teacher.client.transport import OscoreRequests, Response

SILENT_AFTER_S = 1.0
"""Without a picture for so long the robot is asked for them anew."""
_LOOK_EVERY_S = 0.1
_STATE = "/state"


async def observe(requests: OscoreRequests, pictures: StateStream, now: Callable[[], float]) -> None:
    """Fill `pictures` until cancelled; `now` is a monotonic clock in seconds."""
    while True:
        before, began_s, newest = pictures.count, now(), -2

        def on_response(response: Response) -> None:
            nonlocal newest
            # A captured picture that is sent again must not be shown, and none may overtake a newer one.
            if response.number <= newest:
                return
            newest = response.number
            _show(response, requests, pictures)

        observation = requests.observe(_STATE, on_response)
        while True:
            await anyio.sleep(_LOOK_EVERY_S)
            came = pictures.count > before
            if observation.ended and came:
                break
            if now() - began_s > SILENT_AFTER_S and pictures.age_s > SILENT_AFTER_S:
                break
        observation.end()
        if pictures.count == before:
            await requests.find_robot()  # it may have another address by now


def _show(response: Response, requests: OscoreRequests, pictures: StateStream) -> None:
    if not response.successful:
        requests.trouble = f"the robot shows no picture: {response.code}"
        return
    try:
        picture = decode_state(response.payload)
    except WireError as error:
        requests.trouble = (
            f"the robot's picture is not understood, it may be of another version: {error}; bring kurt2rt up to date "
            "on the robot and on this device"
        )
    else:
        pictures.show(picture)
