"""Access to a device's page: pairing token, cookie, host and origin of a request."""

import hashlib
import hmac
from collections.abc import Collection, Mapping

from kurt2rt.teacher.page.host_names import is_own_host
from kurt2rt.teacher.page.public_address import PublicAddress


class Access:
    """Rules by which the page of one device accepts a visitor: token, cookie, host and origin.

    The cookie is derived from the token, so a renewed or revoked pairing ends it.
    """

    def __init__(
        self,
        device: str,
        token: str,
        names: Collection[str],
        public: PublicAddress | None = None,
        *,
        address_command: str = "kurt2rt run --phone",
    ) -> None:
        """Create the rules of a paired device.

        Args:
            device: name of the device.
            token: secret of its pairing.
            names: of this machine, as a browser may write them in an address.
            public: address at which a TLS proxy serves the page, if any.
            address_command: command that shows the page's address.
        """
        self.device = device
        self.address_command = address_command
        self.public = public
        self._token = token.encode()
        self._names = frozenset(name.lower() for name in names)
        # A cookie holds for all ports: the pages of two devices, or of two robots, on one machine need two names.
        self.cookie_name = f"kurt2rt-{device}-{hashlib.sha256(self._token).hexdigest()[:8]}"
        self.cookie = hmac.new(self._token, b"kurt2rt page", hashlib.sha256).hexdigest()

    def accepts_token(self, token: str) -> bool:
        """Return whether this is the token, in constant time."""
        return hmac.compare_digest(token.encode("utf-8", "surrogatepass"), self._token)

    def accepts_cookies(self, cookies: Mapping[str, str]) -> bool:
        """Return whether a browser's cookies hold this device's cookie, in constant time."""
        sent = cookies.get(self.cookie_name, "")
        return hmac.compare_digest(sent.encode("utf-8", "surrogatepass"), self.cookie.encode())

    def is_own_host(self, headers: Mapping[str, str], local_address: str) -> bool:
        """Return whether the Host header names this machine; another name may be DNS rebinding."""
        return self.is_public(headers) or is_own_host(headers.get("host", ""), local_address, self._names)

    def is_public(self, headers: Mapping[str, str]) -> bool:
        """Return whether the request came through the TLS proxy, which passes on the Host header of the browser."""
        return self.public is not None and headers.get("host", "").lower() == self.public.place

    def is_own_origin(self, headers: Mapping[str, str]) -> bool:
        """Return whether a page of this server sent the request."""
        host = headers.get("host", "")
        origin = headers.get("origin", "").lower()
        if self.public is not None and origin == self.public.origin:
            return True
        return origin == f"http://{host.lower()}"
