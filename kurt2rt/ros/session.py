"""Connection to ROS 2 over zenoh: to a router, a bridge or another program (docs/other-robots.md)."""

import json
import threading
import time
from collections.abc import Callable, Sequence
from itertools import count
from secrets import token_bytes
from typing import NamedTuple

import zenoh
from zenoh import ZBytes
from zenoh.ext import Int64, ZDeserializeError, z_deserialize, z_serialize

from kurt2rt.ros.messages import EMPTY_REQUEST, Message, decode_trigger_response, encode, encode_trigger_response
from kurt2rt.ros.port import OnPayload, RosConnectionError
from kurt2rt.ros.settings import Naming, RosSettings
from kurt2rt.ros.topic import Topic, key_expression, liveliness_key, node_liveliness_key

REMEDY = "check the address, the network, and the bridge, router or robot behind it"


_GID_BYTES = 16


class RequestId(NamedTuple):
    """Sequence number and sender of a request, which its response repeats."""

    sequence_number: int
    gid: bytes


class AttachmentSource:
    """Attachments of one publisher, service or client: number, time and sender (rmw_zenoh 0.2.4 and newer)."""

    def __init__(self) -> None:
        """Choose an identifier of 16 bytes by chance."""
        self._gid = token_bytes(_GID_BYTES)
        self._numbers = count(1)

    def next(self) -> ZBytes:
        """Return the attachment of the next message or request."""
        return _serialized(RequestId(next(self._numbers), self._gid))


def response_attachment(request: RequestId) -> ZBytes:
    """Return the attachment of the response to a request."""
    return _serialized(request)


def read_request_id(attachment: ZBytes | None) -> RequestId | None:
    """Return the identity of a request; None without a valid attachment, as the bridge sends none."""
    if attachment is None:
        return None
    try:
        number, _, gid = z_deserialize(tuple[Int64, Int64, bytes], attachment)
    except ZDeserializeError:
        return None
    return RequestId(int(number), gid) if len(gid) == _GID_BYTES else None


def _serialized(request: RequestId) -> ZBytes:
    return z_serialize((Int64(request.sequence_number), Int64(time.time_ns()), request.gid))


class ZenohSession:
    """One zenoh session. Callbacks run in zenoh's threads; all methods may be called from any thread."""

    def __init__(self, settings: RosSettings, *, connect: Sequence[str] = (), listen: Sequence[str] = ()) -> None:
        """Open the session; it finds the other end again by itself after a loss.

        Args:
            settings: names of topics on zenoh.
            connect: locators to connect to, such as "tcp/127.0.0.1:7447"; of a router, a bridge or a listening program.
            listen: locators to listen at. A session that listens waits for nothing; one that connects does not open
                while there is nothing to connect to.

        Raises RosConnectionError if the other end is not there, or a locator is invalid.
        """
        self._settings = settings
        self._name = f"zenoh:{','.join(connect or listen)}"
        self._transports: set[str] = set()
        self._lock = threading.Lock()
        self._entities = count(1)
        try:
            self._session = zenoh.open(_config(connect, listen))
            self._listener = self._session.info.declare_transport_events_listener(self._on_transport, history=True)
        except zenoh.ZError as error:
            raise self._failed(error) from error
        self._session_id = str(self._session.zid())
        self._declared: list[object] = [self._listener]
        """Declarations end when their objects are deleted."""
        if self._announces:
            self._declare_token(node_liveliness_key(settings, self._session_id))

    @property
    def name(self) -> str:
        """Name for messages, such as "zenoh:tcp/127.0.0.1:7447"."""
        return self._name

    @property
    def connected(self) -> bool:
        """True while at least one other zenoh program is connected."""
        return bool(self._transports)

    def publisher(self, topic: Topic) -> "ZenohPublisher":
        """Return the sender of a topic's messages. Raises RosConnectionError if the session is closed."""
        key = key_expression(topic, self._settings)
        try:
            # DROP: a tick never waits for a slow network.
            publisher = self._session.declare_publisher(
                key, congestion_control=zenoh.CongestionControl.DROP, express=True
            )
        except zenoh.ZError as error:
            raise self._failed(error) from error
        self._announce(topic, "MP")
        return ZenohPublisher(publisher, AttachmentSource() if self._announces else None)

    def subscribe(self, topic: Topic, on_payload: OnPayload) -> None:
        """Call `on_payload` with each message of a topic that another session sends from now on.

        Raises RosConnectionError if the session is closed.
        """

        def on_sample(sample: zenoh.Sample) -> None:
            on_payload(sample.payload.to_bytes())

        try:
            subscriber = self._session.declare_subscriber(
                key_expression(topic, self._settings), on_sample, allowed_origin=zenoh.Locality.REMOTE
            )
        except zenoh.ZError as error:
            raise self._failed(error) from error
        self._declared.append(subscriber)
        self._announce(topic, "MS")

    def serve(self, service: Topic, on_request: "Callable[[TriggerRequest], None]") -> None:
        """Offer a std_srvs/srv/Trigger service. Raises RosConnectionError if the session is closed.

        `on_request` gets each request in zenoh's thread. It keeps it and returns; any thread may answer later.
        """
        key = key_expression(service, self._settings)

        def on_query(query: zenoh.Query) -> None:
            on_request(TriggerRequest(query, key, read_request_id(query.attachment)))

        try:
            # Clients of rmw_zenoh ask complete queryables alone.
            self._declared.append(self._session.declare_queryable(key, on_query, complete=True))
        except zenoh.ZError as error:
            raise self._failed(error) from error
        self._announce(service, "SS")

    def call(self, service: Topic, *, timeout_s: float) -> tuple[bool, str]:
        """Call a std_srvs/srv/Trigger service and wait; return success and text of its response.

        Raises RosConnectionError without an answer within `timeout_s`, or kurt2rt.ros.messages.InvalidMessageError.
        """
        try:
            replies = self._session.get(
                key_expression(service, self._settings),
                payload=EMPTY_REQUEST,
                attachment=AttachmentSource().next() if self._announces else None,
                target=zenoh.QueryTarget.ALL_COMPLETE if self._announces else None,
                timeout=timeout_s,
            )
            for reply in replies:
                if reply.ok is not None:
                    return decode_trigger_response(reply.ok.payload.to_bytes())
        except zenoh.ZError as error:
            raise self._failed(error) from error
        raise RosConnectionError(
            f"service {service.name} gave no answer within {timeout_s:g} s", where=self._name, do=REMEDY
        )

    def close(self) -> None:
        """Close the session; may be called twice."""
        self._session.close()  # type: ignore[no-untyped-call]  # zenoh's stub names no return type
        self._transports = set()

    @property
    def _announces(self) -> bool:
        """True where rmw_zenoh is at the other end: it wants attachments, and sees entities by their tokens."""
        return self._settings.naming is not Naming.BRIDGE

    def _announce(self, topic: Topic, kind: str) -> None:
        if self._announces:
            number = next(self._entities)
            self._declare_token(liveliness_key(topic, self._settings, self._session_id, kind, number))

    def _declare_token(self, key: str) -> None:
        self._declared.append(self._session.liveliness().declare_token(key))

    def _on_transport(self, event: zenoh.TransportEvent) -> None:
        peer = str(event.transport.zid)
        with self._lock:
            # A new set each time: the tick reads it without the lock.
            if event.kind == zenoh.SampleKind.PUT:  # each access makes an object of its own
                self._transports = self._transports | {peer}
            else:
                self._transports = self._transports - {peer}

    def _failed(self, error: zenoh.ZError) -> RosConnectionError:
        return RosConnectionError(_first_line(error), where=self._name, do=REMEDY)


class ZenohPublisher:
    """Sender of one topic's messages over zenoh (kurt2rt.ros.port.Publisher)."""

    def __init__(self, publisher: zenoh.Publisher, attachments: AttachmentSource | None) -> None:
        """Send by `publisher`, with `attachments` where rmw_zenoh reads them."""
        self._publisher, self._attachments = publisher, attachments

    def publish(self, message: Message) -> None:
        """Send a message without waiting; it is lost while nothing is connected.

        Raises RosConnectionError if the session is closed, or kurt2rt.ros.messages.InvalidMessageError.
        """
        payload = encode(message)
        try:
            self._publisher.put(payload, attachment=self._attachments.next() if self._attachments else None)
        except zenoh.ZError as error:
            raise RosConnectionError(_first_line(error), do=REMEDY) from error


class TriggerRequest:
    """One request of a std_srvs/srv/Trigger service, to be answered once."""

    def __init__(self, query: zenoh.Query, key: str, request_id: RequestId | None) -> None:
        """Keep zenoh's query; `request_id` is rmw_zenoh's, None from others."""
        self._query, self._key, self._id = query, key, request_id

    def respond(self, success: bool, text: str) -> None:
        """Answer. Raises RosConnectionError if the session is closed or the request was answered before."""
        attachment = None if self._id is None else response_attachment(self._id)
        try:
            with self._query:  # the client waits until the query is dropped
                self._query.reply(self._key, encode_trigger_response(success, text), attachment=attachment)
        except zenoh.ZError as error:
            raise RosConnectionError(_first_line(error), do=REMEDY) from error


def _config(connect: Sequence[str], listen: Sequence[str]) -> zenoh.Config:
    config = zenoh.Config()
    values = {
        # A client's router forwards to all its other clients and peers; peers alone would have to reach each other.
        "mode": "peer" if listen else "client",
        "listen/endpoints": list(listen),
        "connect/endpoints": list(connect),
        "connect/timeout_ms": 0,
        "scouting/multicast/enabled": False,
        # The tick drops a message at once that does not fit into the queue; zenoh would wait 1 ms.
        "transport/link/tx/queue/congestion_control/drop/wait_before_drop": 0,
    }
    for key, value in values.items():
        config.insert_json5(key, json.dumps(value))
    return config


def _first_line(error: zenoh.ZError) -> str:
    return str(error).partition(" at /")[0].strip()
