"""Address at which a TLS proxy serves the page."""

from dataclasses import dataclass
from urllib.parse import urlsplit

from config.errors import UserError

_HTTPS_PORT = 443


class PageError(UserError):
    """Page that cannot be served: no free TCP port, or an invalid public address."""


@dataclass(frozen=True, slots=True)
class PublicAddress:
    """Address of a proxy that speaks TLS and forwards to this server, without a path."""

    place: str
    """Host, and port unless it is 443, as browsers write them into the Host header."""

    @property
    def origin(self) -> str:
        """Value of a browser's Origin header, such as https://robot.example."""
        return f"https://{self.place}"


def public_address(text: str) -> PublicAddress:
    """Parse an address such as https://robot.example. Raises PageError for any other form."""
    wrong = PageError(f"--public-address {text!r}: give https:// and a name, with a port if need be, and nothing more")
    try:
        parts = urlsplit(text.strip().lower())
        host, port = parts.hostname, parts.port
    except ValueError:
        raise wrong from None
    more = parts.path.strip("/") or parts.query or parts.fragment or parts.username or parts.password
    if parts.scheme != "https" or not host or more or not parts.netloc.isascii() or any(c in host for c in " ;,'\""):
        raise wrong
    shown = f"[{host}]" if ":" in host else host
    return PublicAddress(shown if port in (None, _HTTPS_PORT) else f"{shown}:{port}")
