"""Resources of the robot; all but discovery need the key of a paired device."""

import asyncio
from typing import Any, Protocol

import aiocoap
from aiocoap import oscore
from aiocoap.error import RenderableError
from aiocoap.numbers.constants import TransportTuning

from kurt2rt.channel.protocol.codec import CONTENT_FORMAT, PATHS, decode_request, encode_answer
from kurt2rt.channel.server.reply import Reply, ReplyStatus, malformed
from kurt2rt.channel.server.request_handler import RequestHandler, Sender
from kurt2rt.channel.server.sealed_request import SealedRequest
from kurt2rt.core.message_fields import WireError

_CODES = {
    ReplyStatus.DONE: aiocoap.CHANGED,
    ReplyStatus.MALFORMED: aiocoap.BAD_REQUEST,
    ReplyStatus.NOT_HERE: aiocoap.NOT_FOUND,
    ReplyStatus.CONFLICT: aiocoap.CONFLICT,
    ReplyStatus.UNSAVED: aiocoap.SERVICE_UNAVAILABLE,
}
_STATE = "/state"
_DISCOVERY = ("GET", "/.well-known/core")
_LINK_FORMAT = 40
_SMALL_BLOCK = 1
"""Size exponent of a block of 32 bytes (RFC 7959, 2.2)."""
_CONFIRMED_EVERY_S = 1.0
_OBSERVE_MASK = 0xFFFFFF
"""An Observe number has 24 bits (RFC 7641, 4.4); some clients refuse longer ones."""


class _Loose(TransportTuning):  # type: ignore[misc]  # aiocoap has no types
    """Tuning of states: sent once, because the next state replaces a lost one."""

    reliability = False


class _Confirmed(TransportTuning):  # type: ignore[misc]
    """Tuning of the state after a silent second of its observer, to notice an observer that is gone.

    Others are not confirmable: at 30 % loss each way aiocoap would give up one in fifteen, and end the observation.
    """

    reliability = True
    ACK_TIMEOUT = 0.3
    MAX_RETRANSMIT = 3


class Keys(Protocol):
    """Robot's keys of all paired devices, by which aiocoap decrypts a request and finds its sender."""

    def find(self, unprotected: Any) -> Any:
        """Return the security context that a message names. Raises KeyError."""
        ...


class SenderRegistry(Protocol):
    """Receiver of senders that proved to hold a key, to give them a rate of their own (`Endpoint`)."""

    def mark_proven(self, remote: Any) -> None:
        """Note that `remote`, a sender's address, has sent a message that only a key holder can make."""
        ...


class _Observer:
    """Observer of the states; a slow one misses older states."""

    def __init__(self, remote: Any, device: str, now_s: float) -> None:
        self.remote = remote
        self.device = device
        self.heard_s = now_s
        """Time of the last authenticated message from it, in the loop's time."""
        self.asked_s = float("-inf")
        """Time of the last state that it was asked to confirm."""
        self.over = False
        self.skipped = 0
        """Number of states that replaced a state before it was sent."""
        self._newest = b""
        self._is_new = asyncio.Event()

    def publish(self, state: bytes) -> None:
        self.skipped += self._is_new.is_set()
        self._newest = state
        self._is_new.set()

    def end(self) -> None:
        """End the observation."""
        self.over = True
        self._is_new.set()

    async def state(self) -> bytes:
        await self._is_new.wait()
        self._is_new.clear()
        return self._newest


class RobotSite:
    """Answers of the robot to each path (aiocoap's site); it checks the key first, then asks the handler."""

    def __init__(self, keys: Keys, handler: RequestHandler) -> None:
        self._keys = keys
        self._handler = handler
        self._observers: set[_Observer] = set()
        self._state = b""
        self._skipped = 0
        self.senders: SenderRegistry | None = None
        """Registry of proven senders; `open_channel` sets it before the first request."""
        self.failures = 0
        """Number of requests that ended in an error of the program; none should."""

    @property
    def observers(self) -> int:
        """Number of devices that get the states."""
        return len(self._observers)

    @property
    def states_skipped(self) -> int:
        """Number of states that observers missed because the one before was still on its way."""
        return self._skipped + sum(each.skipped for each in self._observers)

    def is_reachable(self, remote: Any) -> bool:
        """Return whether an observer at `remote` sent an authenticated message in the last second."""
        now_s = asyncio.get_running_loop().time()
        return any(each.remote == remote and now_s - each.heard_s < _CONFIRMED_EVERY_S for each in self._observers)

    def key_of(self, sealed: SealedRequest) -> Any:
        """Return the security context (aiocoap's) that an OSCORE request names; None if there is none."""
        header = {oscore.COSE_KID: sealed.kid}
        if sealed.kid_context is not None:
            header[oscore.COSE_KID_CONTEXT] = sealed.kid_context
        try:
            return self._keys.find(header)
        except KeyError:
            return None

    @property
    def waits_for_state(self) -> bool:
        """True if a device waits for its first state."""
        return bool(self._observers) and not self._state

    def forget_state(self) -> None:
        """Let the next device wait for a new state, because none is published without an observer."""
        self._state = b""

    def publish(self, state: bytes) -> None:
        """Send a state, encoded by `encode_state`, to all observers; never waits."""
        self._state = state
        for observer in self._observers:
            observer.publish(state)

    async def render_to_pipe(self, pipe: Any) -> None:
        """Answer one request; aiocoap calls it in a task of its own.

        `pipe` (aiocoap.pipe.Pipe) holds the request and takes the responses; the state has one response per
        publication. Messages without a valid key get no answer. Raises aiocoap.oscore.ContextUnavailable if the disk
        does not take the sequence number of the answer.
        """
        try:
            unprotected = oscore.verify_start(pipe.request)
        except oscore.NotAProtectedMessage:
            pipe.add_response(_answer_stranger(pipe.request), is_last=True)
            return
        except Exception:  # noqa: BLE001 - forged options make the library raise many things
            return  # the endpoint ends an exchange without an answer
        try:
            keys = self._keys.find(unprotected)
            request, request_id = keys.unprotect(pipe.request)
        except RenderableError as error:  # after a restart: prove that this message is new (RFC 8613, B.1.2)
            pipe.add_response(error.to_message(), is_last=True)
            return
        except Exception:  # noqa: BLE001 - no key, or not made with it; for forged bytes also as above
            # Silence, also to a confirmable message: strangers learn nothing, and nothing is amplified.
            return
        if self.senders is not None:
            self.senders.mark_proven(pipe.request.remote)
        now_s = asyncio.get_running_loop().time()
        for observer in self._observers:
            if observer.remote == pipe.request.remote:
                observer.heard_s = now_s
        sender = Sender(keys.authenticated_claims[0], keys.recipient_id, int.from_bytes(request_id.partial_iv, "big"))
        try:
            if (request.code, path_of(request)) == (aiocoap.GET, _STATE):
                await self._send_states(pipe, request, keys, request_id, sender.device)
                return
            response = await self._respond(request, sender)
            pipe.add_response(_protected(keys, response, request_id), is_last=True)
        except oscore.ContextUnavailable:
            # Revoked or renewed meanwhile: silence, as for unknown keys. A failing disk is an error.
            if not keys.closed:
                raise

    async def _respond(self, request: Any, sender: Sender) -> aiocoap.Message:
        path = path_of(request)
        if (str(request.code), path) == _DISCOVERY:
            return aiocoap.Message(code=aiocoap.CONTENT, payload=_links(), content_format=_LINK_FORMAT)
        if path not in PATHS:
            return aiocoap.Message(code=aiocoap.NOT_FOUND)
        if request.code != aiocoap.POST:
            return aiocoap.Message(code=aiocoap.METHOD_NOT_ALLOWED)
        try:
            wanted = decode_request(path, request.payload)
        except WireError as error:
            return _message(malformed(str(error)))
        try:
            return _message(await self._handler.answer(sender, wanted))
        except Exception:  # noqa: BLE001 - the loop goes on after any request of a key holder; counted and shown
            self.failures += 1
            return aiocoap.Message(code=aiocoap.INTERNAL_SERVER_ERROR)

    async def _send_states(self, pipe: Any, request: Any, keys: Any, request_id: Any, device: str) -> None:
        loop = asyncio.get_running_loop()
        observer = _Observer(pipe.request.remote, device, loop.time())
        if request.opt.observe == 0:
            # A device has one observation: a new registration ends the one before, which may have been lost.
            for other in self._observers:
                if other.device == device:
                    other.end()
        self._observers.add(observer)
        try:
            state = self._state or await observer.state()
            if request.opt.observe != 0:
                pipe.add_response(_protected(keys, _state_message(state), request_id), is_last=True)
                return
            while not observer.over:
                message = _state_message(state)
                message.opt.observe = 0
                message.transport_tuning = _Loose()
                if loop.time() - max(observer.heard_s, observer.asked_s) >= _CONFIRMED_EVERY_S:
                    observer.asked_s = loop.time()
                    message.transport_tuning = _Confirmed()
                outer = _protected(keys, message, request_id)
                outer.opt.observe = keys.sender_sequence_number & _OBSERVE_MASK
                pipe.add_response(outer, is_last=False)
                state = await observer.state()
        finally:  # aiocoap cancels this task when the device is gone
            self._observers.discard(observer)
            self._skipped += observer.skipped


def path_of(request: Any) -> str:
    """Return the path of a request (aiocoap.Message), such as /correct."""
    return "/" + "/".join(request.opt.uri_path)


def _answer_stranger(request: Any) -> aiocoap.Message:
    if (str(request.code), path_of(request)) == _DISCOVERY:
        return _part_of_discovery(request.opt.block2)
    return aiocoap.Message(code=aiocoap.UNAUTHORIZED)


def _part_of_discovery(wanted: Any) -> aiocoap.Message:
    """Return one block of the links (RFC 7959).

    The sender's address may be forged, so an answer has at most three times the bytes of its request. A request has at
    least 21, an answer with 32 of the links at most 44, and both have the same token.
    """
    links = _links()
    exponent, start = _SMALL_BLOCK, 0
    if wanted is not None:
        exponent, start = min(exponent, wanted.size_exponent), wanted.start
    size = 16 << exponent
    if start >= len(links):
        return aiocoap.Message(code=aiocoap.BAD_REQUEST)
    message = aiocoap.Message(code=aiocoap.CONTENT, payload=links[start : start + size], content_format=_LINK_FORMAT)
    message.opt.block2 = (start // size, start + size < len(links), exponent)
    return message


def _links() -> bytes:
    links = [f"<{_STATE}>;obs;osc;ct={CONTENT_FORMAT}", *(f"<{path}>;osc" for path in PATHS)]
    return ",".join(links).encode()


def _state_message(state: bytes) -> aiocoap.Message:
    return aiocoap.Message(code=aiocoap.CONTENT, payload=state, content_format=CONTENT_FORMAT)


def _message(reply: Reply) -> aiocoap.Message:
    return aiocoap.Message(code=_CODES[reply.status], payload=encode_answer(reply.body), content_format=CONTENT_FORMAT)


def _protected(keys: Any, message: aiocoap.Message, request_id: Any) -> aiocoap.Message:
    outer, _ = keys.context_for_response().protect(message, request_id)
    protected: aiocoap.Message = outer
    return protected
