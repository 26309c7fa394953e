"""The robot's resources: everything but discovery is for teachers whose device has a key."""

import asyncio
from typing import Any, Protocol

import aiocoap
from aiocoap import oscore
from aiocoap.error import RenderableError
from aiocoap.numbers.constants import TransportTuning

from kurt2rt.channel.protocol.codec import CONTENT_FORMAT, PATHS, WireError, decode_request, encode_answer
from kurt2rt.channel.server.reply import Reply, ReplyStatus, malformed
from kurt2rt.channel.server.request_handler import RequestHandler, Sender
from kurt2rt.channel.server.sealed_request import SealedRequest

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
    """A picture: the next one is better than this one again."""

    reliability = False


class _Confirmed(TransportTuning):  # type: ignore[misc]
    """After a second without another sign of an observer, so that one who is gone is noticed.

    Not while there are signs: at 30 % loss each way one in fifteen is given up, and the pictures with it.
    """

    reliability = True
    ACK_TIMEOUT = 0.3
    MAX_RETRANSMIT = 3


class Keys(Protocol):
    """The robot's side of all pairings."""

    def find(self, unprotected: Any) -> Any:
        """The security context that a message names. Raises KeyError."""
        ...


class SenderRegistry(Protocol):
    """Is told which senders are no strangers."""

    def proved(self, remote: Any) -> None:
        """This sender has just sent something that only a key holder can make."""
        ...


class _Observer:
    """One who gets every picture; a slow one misses the older ones."""

    def __init__(self, remote: Any, device: str, now_s: float) -> None:
        self.remote = remote
        self.device = device
        self.heard_s = now_s
        """When something came that only he can have sent; of the loop's time."""
        self.asked_s = float("-inf")
        """When he was last asked whether he is there."""
        self.over = False
        self.skipped = 0
        """Pictures that came before the one before them was taken."""
        self._newest = b""
        self._is_new = asyncio.Event()

    def show(self, picture: bytes) -> None:
        self.skipped += self._is_new.is_set()
        self._newest = picture
        self._is_new.set()

    def end(self) -> None:
        """No more pictures for this one."""
        self.over = True
        self._is_new.set()

    async def picture(self) -> bytes:
        await self._is_new.wait()
        self._is_new.clear()
        return self._newest


class RobotSite:
    """Answers requests (what aiocoap calls a site). One place checks the key, for every path."""

    def __init__(self, keys: Keys, reception: RequestHandler) -> None:
        self._keys = keys
        self._reception = reception
        self._observers: set[_Observer] = set()
        self._picture = b""
        self._skipped = 0
        self.doorkeeper: SenderRegistry | None = None
        """To be set once the endpoint is open; before that nothing arrives."""
        self.failures = 0
        """Requests that ended in an error of ours; none should."""

    @property
    def observers(self) -> int:
        """How many get the pictures."""
        return len(self._observers)

    @property
    def pictures_skipped(self) -> int:
        """Pictures that observers did not get, because the one before was still on its way to them."""
        return self._skipped + sum(each.skipped for each in self._observers)

    def hears(self, remote: Any) -> bool:
        """Whether an observer there has just said something, so that he is not gone."""
        now_s = asyncio.get_running_loop().time()
        return any(each.remote == remote and now_s - each.heard_s < _CONFIRMED_EVERY_S for each in self._observers)

    def key_of(self, sealed: SealedRequest) -> Any:
        """Return the security context that an OSCORE request names; None if there is none."""
        header = {oscore.COSE_KID: sealed.kid}
        if sealed.kid_context is not None:
            header[oscore.COSE_KID_CONTEXT] = sealed.kid_context
        try:
            return self._keys.find(header)
        except KeyError:
            return None

    def show(self, picture: bytes) -> None:
        """A new encoded picture for everyone who looks."""
        self._picture = picture
        for observer in self._observers:
            observer.show(picture)

    async def render_to_pipe(self, pipe: Any) -> None:
        """Answer one request; called by aiocoap in a task of its own."""
        try:
            unprotected = oscore.verify_start(pipe.request)
        except oscore.NotAProtectedMessage:
            pipe.add_response(_to_a_stranger(pipe.request), is_last=True)
            return
        except Exception:  # noqa: BLE001 - forged options make the library raise many things
            return  # the endpoint ends what is left without an answer
        try:
            keys = self._keys.find(unprotected)
            request, request_id = keys.unprotect(pipe.request)
        except RenderableError as error:  # after a restart: prove that this message is new (RFC 8613, B.1.2)
            pipe.add_response(error.to_message(), is_last=True)
            return
        except Exception:  # noqa: BLE001 - no key, or not made with it; for forged bytes also as above
            # Silence, also to a confirmable message: a stranger learns nothing, and nothing is to be amplified.
            return
        if self.doorkeeper is not None:
            self.doorkeeper.proved(pipe.request.remote)
        now_s = asyncio.get_running_loop().time()
        for observer in self._observers:
            if observer.remote == pipe.request.remote:
                observer.heard_s = now_s
        sender = Sender(keys.authenticated_claims[0], keys.recipient_id, int.from_bytes(request_id.partial_iv, "big"))
        try:
            if (request.code, path_of(request)) == (aiocoap.GET, _STATE):
                await self._show_state(pipe, request, keys, request_id, sender.device)
                return
            response = await self._respond(request, sender)
            pipe.add_response(_protected(keys, response, request_id), is_last=True)
        except oscore.ContextUnavailable:
            # Revoked or renewed meanwhile: silence, as to any key that no device has. A disk that fails is a failure.
            if not keys.closed:
                raise

    async def _respond(self, request: Any, sender: Sender) -> aiocoap.Message:
        path = path_of(request)
        if (str(request.code), path) == _DISCOVERY:
            return _discovery()
        if path not in PATHS:
            return aiocoap.Message(code=aiocoap.NOT_FOUND)
        if request.code != aiocoap.POST:
            return aiocoap.Message(code=aiocoap.METHOD_NOT_ALLOWED)
        try:
            wanted = decode_request(path, request.payload)
        except WireError as error:
            return _message(malformed(str(error)))
        try:
            return _message(await self._reception.answer(sender, wanted))
        except Exception:  # noqa: BLE001 - whatever a key holder sends, the loop goes on; counted and shown
            self.failures += 1
            return aiocoap.Message(code=aiocoap.INTERNAL_SERVER_ERROR)

    async def _show_state(self, pipe: Any, request: Any, keys: Any, request_id: Any, device: str) -> None:
        loop = asyncio.get_running_loop()
        observer = _Observer(pipe.request.remote, device, loop.time())
        if request.opt.observe == 0:
            # A device looks once: when it asks anew it has given up the one before, and does not always say so.
            for other in self._observers:
                if other.device == device:
                    other.end()
        self._observers.add(observer)
        try:
            picture = self._picture or await observer.picture()
            if request.opt.observe != 0:
                pipe.add_response(_protected(keys, _state(picture), request_id), is_last=True)
                return
            while not observer.over:
                message = _state(picture)
                message.opt.observe = 0
                message.transport_tuning = _Loose()
                if loop.time() - max(observer.heard_s, observer.asked_s) >= _CONFIRMED_EVERY_S:
                    observer.asked_s = loop.time()
                    message.transport_tuning = _Confirmed()
                outer = _protected(keys, message, request_id)
                outer.opt.observe = keys.sender_sequence_number & _OBSERVE_MASK
                pipe.add_response(outer, is_last=False)
                picture = await observer.picture()
        finally:  # aiocoap cancels this task when the other side is gone
            self._observers.discard(observer)
            self._skipped += observer.skipped


def path_of(request: Any) -> str:
    """The path that a request names."""
    return "/" + "/".join(request.opt.uri_path)


def _to_a_stranger(request: Any) -> aiocoap.Message:
    if (str(request.code), path_of(request)) == _DISCOVERY:
        return _part_of_discovery(request.opt.block2)
    return aiocoap.Message(code=aiocoap.UNAUTHORIZED)


def _discovery() -> aiocoap.Message:
    return aiocoap.Message(code=aiocoap.CONTENT, payload=_links(), content_format=_LINK_FORMAT)


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


def _state(picture: bytes) -> aiocoap.Message:
    return aiocoap.Message(code=aiocoap.CONTENT, payload=picture, content_format=CONTENT_FORMAT)


def _message(reply: Reply) -> aiocoap.Message:
    return aiocoap.Message(code=_CODES[reply.verdict], payload=encode_answer(reply.body), content_format=CONTENT_FORMAT)


def _protected(keys: Any, message: aiocoap.Message, request_id: Any) -> aiocoap.Message:
    outer, _ = keys.context_for_response().protect(message, request_id)
    protected: aiocoap.Message = outer
    return protected
