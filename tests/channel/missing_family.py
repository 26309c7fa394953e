"""A machine that lacks an address family: its sockets cannot be opened, or have no address to be bound to."""

import errno
import socket
from typing import Any

import pytest


def remove_family(monkeypatch: pytest.MonkeyPatch, family: socket.AddressFamily, *, sockets_open: bool = False) -> None:
    """Refuse all sockets of `family` from now on, or with `sockets_open` to bind them."""

    class Refusing(socket.socket):
        def __init__(self, *kind: Any, **named_kind: Any) -> None:
            super().__init__(*kind, **named_kind)
            if self.family == family and not sockets_open:
                self.close()
                raise OSError(errno.EAFNOSUPPORT, "Address family not supported by protocol")

        def bind(self, address: Any) -> None:
            if self.family == family:
                raise OSError(errno.EADDRNOTAVAIL, "Cannot assign requested address")
            super().bind(address)

    monkeypatch.setattr(socket, "socket", Refusing)
