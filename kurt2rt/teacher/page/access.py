"""Who may see the page: whoever brought the token of the pairing once, from a page of ours."""

import hashlib
import hmac
import secrets
from collections.abc import Collection, Mapping
from typing import Self

from kurt2rt.channel.security.pairing import LOCAL
from kurt2rt.teacher.page.host_names import is_ours
from kurt2rt.teacher.page.public_address import PublicAddress


class Access:
    """The rules of the door. The cookie is derived from the token, so a renewed or revoked pairing ends it."""

    def __init__(
        self,
        device: str,
        token: str,
        names: Collection[str],
        public: PublicAddress | None = None,
        *,
        shown_by: str | None = None,
    ) -> None:
        """`names`: what this machine may be called in an address; `public`: where a TLS proxy serves the page.

        `shown_by`: the command that shows the address; None: kurt2rt teach for this device.
        """
        self.device = device
        teach = "kurt2rt teach" if device == LOCAL else f"kurt2rt teach --as {device}"
        self.shown_by = teach if shown_by is None else shown_by
        self.public = public
        self._token = token.encode()
        self._names = frozenset(name.lower() for name in names)
        # Cookies know no ports: two devices' pages on one machine need two names.
        self.cookie_name = f"kurt2rt-{device}"
        self.cookie = hmac.new(self._token, b"kurt2rt page", hashlib.sha256).hexdigest()

    @classmethod
    def without_device(cls, names: Collection[str]) -> Self:
        """Return rules that refuse all visitors; `names` as for a device."""
        return cls("", secrets.token_urlsafe(), names, shown_by="kurt2rt run --phone")

    def opens(self, token: str) -> bool:
        """Whether this is the token; takes the same time whatever is wrong with it."""
        return hmac.compare_digest(token.encode("utf-8", "surrogatepass"), self._token)

    def knows(self, cookies: Mapping[str, str]) -> bool:
        """Whether a browser brought our cookie."""
        brought = cookies.get(self.cookie_name, "")
        return hmac.compare_digest(brought.encode("utf-8", "surrogatepass"), self.cookie.encode())

    def is_for_us(self, headers: Mapping[str, str], local_address: str) -> bool:
        """Whether the request names this machine as its host; anything else may be DNS rebinding."""
        return self.is_public(headers) or is_ours(headers.get("host", ""), local_address, self._names)

    def is_public(self, headers: Mapping[str, str]) -> bool:
        """Whether the request came for the TLS proxy's address, which hands on the Host that it was asked for."""
        return self.public is not None and headers.get("host", "").lower() == self.public.place

    def comes_from_us(self, headers: Mapping[str, str]) -> bool:
        """Whether a WebSocket was opened by a page of this very server."""
        host = headers.get("host", "")
        origin = headers.get("origin", "").lower()
        if self.public is not None and origin == self.public.origin:
            return True
        return origin == f"http://{host.lower()}"
