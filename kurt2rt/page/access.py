"""Who may see the page: whoever brought the token of the pairing once, from a page of ours."""

import hashlib
import hmac
from collections.abc import Collection, Mapping

from kurt2rt.page.hosts import is_ours


class Access:
    """The rules of the door. The cookie is derived from the token, so a renewed or revoked pairing ends it."""

    def __init__(self, device: str, token: str, names: Collection[str]) -> None:
        """`names`: what this machine may be called in an address."""
        self.device = device
        self._token = token.encode()
        self._names = frozenset(name.lower() for name in names)
        # Cookies know no ports: two devices' pages on one machine need two names.
        self.cookie_name = f"kurt2rt-{device}"
        self.cookie = hmac.new(self._token, b"kurt2rt page", hashlib.sha256).hexdigest()

    def opens(self, token: str) -> bool:
        """Whether this is the token; takes the same time whatever is wrong with it."""
        return hmac.compare_digest(token.encode("utf-8", "surrogatepass"), self._token)

    def knows(self, cookies: Mapping[str, str]) -> bool:
        """Whether a browser brought our cookie."""
        brought = cookies.get(self.cookie_name, "")
        return hmac.compare_digest(brought.encode("utf-8", "surrogatepass"), self.cookie.encode())

    def is_for_us(self, headers: Mapping[str, str], local_address: str) -> bool:
        """Whether the request names this machine as its host; anything else may be DNS rebinding."""
        return is_ours(headers.get("host", ""), local_address, self._names)

    def comes_from_us(self, headers: Mapping[str, str]) -> bool:
        """Whether a WebSocket was opened by a page of this very server."""
        host = headers.get("host", "")
        return headers.get("origin", "").lower() == f"http://{host.lower()}"
