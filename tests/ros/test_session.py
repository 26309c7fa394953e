"""Sessions over real zenoh on the loopback: topics, services, loss and return of the other end."""

from collections.abc import Iterator
from contextlib import ExitStack, closing

import pytest
import zenoh
from zenoh.ext import Int64, z_deserialize

from kurt2rt.ros.messages import String, Twist
from kurt2rt.ros.port import RosConnectionError
from kurt2rt.ros.session import TriggerRequest, ZenohSession
from kurt2rt.ros.settings import Naming, RosSettings
from kurt2rt.ros.topic import key_expression, topic_of, trigger_service
from tests.ros.examples import TWIST
from tests.ros.helpers import free_locator, wait_for

CMD_VEL = topic_of("cmd_vel", Twist)
TEACH = trigger_service("kurt2rt/teach")
NAMINGS = tuple(Naming)


class Ends:
    """A listening session and one that is connected to it."""

    def __init__(self, stack: ExitStack, naming: Naming) -> None:
        self._stack, self.settings, self.locator = stack, RosSettings(naming=naming), free_locator()
        self.robot = self.listen()
        self.runtime = stack.enter_context(closing(ZenohSession(self.settings, connect=[self.locator])))
        wait_for(lambda: self.robot.connected and self.runtime.connected)

    def listen(self) -> ZenohSession:
        return self._stack.enter_context(closing(ZenohSession(self.settings, listen=[self.locator])))

    def deliver(self, received: list[bytes]) -> None:
        """Send from the runtime until a message arrives: a subscription takes a moment to be known."""
        publisher = self.runtime.publisher(CMD_VEL)

        def arrived() -> bool:
            publisher.publish(TWIST)
            return bool(received)

        wait_for(arrived)


@pytest.fixture(params=NAMINGS)
def ends(request: pytest.FixtureRequest) -> Iterator[Ends]:
    with ExitStack() as stack:
        yield Ends(stack, request.param)


@pytest.fixture
def bridged() -> Iterator[Ends]:
    with ExitStack() as stack:
        yield Ends(stack, Naming.BRIDGE)


def test_session_service_answers_from_another_thread(ends: Ends) -> None:
    requests: list[TriggerRequest] = []

    def on_request(request: TriggerRequest) -> None:
        requests.append(request)
        request.respond(True, f"answer {len(requests)}")

    ends.robot.serve(TEACH, on_request)
    wait_for(lambda: _is_served(ends.runtime))
    assert ends.runtime.call(TEACH, timeout_s=20) == (True, f"answer {len(requests)}")


def _is_served(session: ZenohSession) -> bool:
    try:
        return session.call(TEACH, timeout_s=1)[0]
    except RosConnectionError:
        return False


def test_session_rmw_zenoh_message_carries_an_attachment() -> None:
    with ExitStack() as stack:
        ends = Ends(stack, Naming.RMW_ZENOH)
        seen: list[zenoh.Sample] = []
        received: list[bytes] = []
        watcher = stack.enter_context(zenoh.open(_client(ends.locator)))
        watcher.declare_subscriber(key_expression(CMD_VEL, ends.settings), seen.append)
        ends.robot.subscribe(CMD_VEL, received.append)
        publisher = ends.runtime.publisher(CMD_VEL)

        def arrived() -> bool:
            publisher.publish(TWIST)
            return len(seen) > 1

        wait_for(arrived)
        fields = [z_deserialize(tuple[Int64, Int64, bytes], each.attachment) for each in seen if each.attachment]
        assert [number for number, _, _ in fields] == [fields[0][0] + index for index in range(len(seen))]
        assert {len(gid) for _, _, gid in fields} == {16}


def test_session_other_end_closed_is_noticed_and_found_again(bridged: Ends) -> None:
    bridged.robot.close()
    wait_for(lambda: not bridged.runtime.connected)
    received: list[bytes] = []
    robot = bridged.listen()
    robot.subscribe(CMD_VEL, received.append)
    bridged.deliver(received)
    wait_for(lambda: bridged.runtime.connected)


def test_session_without_other_end_is_refused_at_once() -> None:
    locator = free_locator()
    with pytest.raises(RosConnectionError, match=f"zenoh:{locator}: Unable to connect"):
        ZenohSession(RosSettings(), connect=[locator])


def test_session_invalid_locator_is_refused() -> None:
    with pytest.raises(RosConnectionError, match="nonsense"):
        ZenohSession(RosSettings(), connect=["nonsense"])


def test_session_closed_refuses_to_publish_and_subscribe(bridged: Ends) -> None:
    publisher = bridged.runtime.publisher(CMD_VEL)
    bridged.runtime.close()
    bridged.runtime.close()
    assert not bridged.runtime.connected
    with pytest.raises(RosConnectionError):
        publisher.publish(TWIST)
    with pytest.raises(RosConnectionError):
        bridged.runtime.publisher(topic_of("other", String))


def test_session_call_without_service_gives_no_answer(bridged: Ends) -> None:
    with pytest.raises(RosConnectionError, match="gave no answer"):
        bridged.runtime.call(TEACH, timeout_s=0.2)


def _client(locator: str) -> zenoh.Config:
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", f'["{locator}"]')
    config.insert_json5("scouting/multicast/enabled", "false")
    return config
